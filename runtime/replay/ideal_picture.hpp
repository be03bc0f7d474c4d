#pragma once

#include <memory>
#include <optional>
#include <string>

#include "runtime/replay/panel_display.hpp"
#include "runtime/replay/scene.hpp"

namespace brace {

/// Where a head truly is at a vsync's photons: in the middle of the scan-out, and where it was asked for at
/// its first and last line.
struct TruePose {
  Pose world_from_head{};
  std::optional<ScanPoses> scan{};
};

/// The picture that a session's is measured against: a ray for every pixel of both eyes, lit as asked for,
/// the true pose, no warp; with output.ideal = "converged" finer steps, too; with output.ideal_cast =
/// "native" by that raycaster. Everything given must outlive it.
class IdealPicture {
 public:
  /// `scene` is the session's; an ideal picture with finer steps has one of its own, with the same volume.
  /// Throws input_error where a session asks for an ideal that its stages cannot give.
  IdealPicture(const gpu::Device& device, const Session& session, const Headset& headset,
               SceneOnDevice& scene, const VolumePlacement& placement, const ReplayOptions& options);

  /// What the panels would show a head at this pose; with output.ideal_pose = "lines" one that moves between
  /// those of the scan-out's first and last line.
  PanelPair show(const TruePose& head);

  /// What the pictures depend on beside the heads' poses and the transfer function's version.
  const std::string& identity() const { return identity_; }

  bool has_own_scene() const { return own_scene_ != nullptr; }
  SceneOnDevice& scene() { return scene_; }
  /// Call after the scene's transfer function has changed.
  void transfer_changed() { renderer_.transfer_changed(); }

 private:
  const gpu::Device& device_;
  const Headset& headset_;
  Session session_;
  std::unique_ptr<SceneOnDevice> own_scene_;  // null where the session's serves
  SceneOnDevice& scene_;
  EyeRenderer renderer_;
  PanelDisplay display_;
  EyePair eyes_;
  std::string identity_;
};

}  // namespace brace
