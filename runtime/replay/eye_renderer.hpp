#pragma once

#include <array>
#include <memory>

#include "runtime/frame/frame_work.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/raycast/native_steps.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/scene.hpp"

namespace brace {

/// The pictures of both eyes, indexed by sim::Eye.
using EyePair = std::array<EyeTarget, 2>;

EyePair make_eye_pair(const gpu::Device& device, PictureSize size);

/// Ray casts both eyes of a head pose. Everything given must outlive it.
class EyeRenderer {
 public:
  enum class Counting { off, on };

  /// The session's stages for rays, cast and skip are taken from its pipeline; rays and cast may be native.
  /// Throws input_error for another native one, device_error when a stage cannot be activated.
  EyeRenderer(const gpu::Device& device, const Session& session, const Headset& headset,
              const SceneOnDevice& scene, const VolumePlacement& placement,
              const std::filesystem::path& data_folder, Counting counting);

  JobOutcome render(const Pose& world_from_head, const EyePair& into);

  /// Call after the scene's transfer function has changed: native stages, which have it from their
  /// activation, are activated anew.
  void transfer_changed();

 private:
  void activate_native_stages();
  JobOutcome render_with_native_stages(const Pose& world_from_head, const EyePair& into);

  const gpu::Device& device_;
  const Session& session_;
  const Headset& headset_;
  const SceneOnDevice& scene_;
  VolumePlacement placement_;
  Counting counting_;
  CastPipeline pipeline_;
  RayBuffers rays_;
  gpu::CommandList commands_;

  // Empty where the pipeline's kernels do the work. The stages are deactivated before what they point to
  // goes.
  std::unique_ptr<StageActivation> activation_;
  NativeStage native_rays_, native_cast_;
  HostRays host_rays_;
  std::uint64_t frame_ = 0;
};

}  // namespace brace
