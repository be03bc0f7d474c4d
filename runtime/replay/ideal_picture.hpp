#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "runtime/replay/panel_display.hpp"
#include "runtime/replay/scene.hpp"

namespace brace {

/// The picture that a session's is measured against: a ray for every pixel of both eyes, lit as asked for,
/// the true pose, no warp; with output.ideal = "converged" finer steps, too. Everything given must outlive
/// it.
class IdealPicture {
 public:
  /// `scene` is the session's; an ideal picture with finer steps has one of its own, with the same volume.
  /// Throws input_error where a session asks for a converged ideal that its cast stage cannot give.
  IdealPicture(const gpu::Device& device, const Session& session, const Headset& headset,
               SceneOnDevice& scene, const VolumePlacement& placement, const ReplayOptions& options);

  /// What the panels would show a head at this pose; with output.ideal_pose = "lines" one that moves between
  /// those of the scan-out's first and last line.
  PanelPair show(const Pose& true_world_from_head, const std::optional<ScanPoses>& true_scan = {});

  bool has_own_scene() const { return own_scene_ != nullptr; }
  SceneOnDevice& scene() { return scene_; }
  /// Call after the scene's transfer function has changed.
  void transfer_changed() { renderer_.transfer_changed(); }

 private:
  Session session_;
  std::unique_ptr<SceneOnDevice> own_scene_;  // null where the session's serves
  SceneOnDevice& scene_;
  EyeRenderer renderer_;
  PanelDisplay display_;
  EyePair eyes_;
};

}  // namespace brace
