#pragma once

#include <array>
#include <memory>
#include <optional>

#include "runtime/frame/frame_work.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/raycast/native_steps.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/scene.hpp"
#include "runtime/replay/scene_activation.hpp"

namespace brace {

/// The pictures of both eyes, indexed by sim::Eye.
using EyePair = std::array<EyeTarget, 2>;

EyePair make_eye_pair(const gpu::Device& device, PictureSize size);

/// Ray casts both eyes of a head pose. Everything given must outlive it.
class EyeRenderer {
 public:
  enum class Counting { off, on };

  /// The session's stages for rays, cast, skip and stereo are taken from its pipeline; any may be native.
  /// Throws device_error when a stage cannot be activated. `watchdog` may be null; what it watches is checked
  /// after every eye.
  EyeRenderer(const gpu::Device& device, const Session& session, const Headset& headset,
              const SceneOnDevice& scene, const VolumePlacement& placement,
              const std::filesystem::path& data_folder, Counting counting, Watchdog* watchdog = nullptr);

  JobOutcome render(const Pose& world_from_head, const EyePair& into);

  /// Call after the scene's transfer function has changed: native stages, which have it from their
  /// activation, are activated anew.
  void transfer_changed();

 private:
  void activate_native_stages();
  JobOutcome render_by_steps(const Pose& world_from_head, const EyePair& into);
  EyeCastOutcome cast_eye_by_steps(sim::Eye eye, const Pose& world_from_head, const EyeTarget& target);
  std::int64_t compose_right_eye(const Pose& world_from_head, const EyePair& into);

  const gpu::Device& device_;
  const Session& session_;
  const Headset& headset_;
  const SceneOnDevice& scene_;
  VolumePlacement placement_;
  Counting counting_;
  CastPipeline pipeline_;
  RayBuffers rays_;
  gpu::CommandList commands_;

  // Empty where the pipeline's kernels do the work.
  std::optional<ActiveStage> native_rays_, native_cast_, native_stereo_;
  HostRays host_rays_;
  Watchdog* watchdog_ = nullptr;
  std::uint64_t frame_ = 0;
};

}  // namespace brace
