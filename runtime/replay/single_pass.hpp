#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "runtime/frame/frame_work.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/scene.hpp"
#include "runtime/stereo/stereo_layers.hpp"

namespace brace {

/// The pictures of both eyes, indexed by sim::Eye.
using EyePair = std::array<EyeTarget, 2>;

/// Whether the session's stereo stage is stereo/layers.
bool is_single_pass(const Session& session);

/// Layers, near plane and memory of the session's stereo/layers. Throws input_error for stages that it cannot
/// work with, headsets whose eyes no shift connects, and layers that do not fit.
StereoPlan plan_single_pass(const gpu::Device& device, const Session& session, const Headset& headset,
                            const VolumeInfo& volume, const VolumePlacement& placement);

/// Renders both eyes by casting the left one's rays alone. Everything given must outlive it.
class SinglePass {
 public:
  struct Inputs {
    const gpu::Device& device;
    const Session& session;
    const Headset& headset;
    const SceneOnDevice& scene;
    const VolumePlacement& placement;
    const std::filesystem::path& data_folder;
  };

  /// `kernels`: the session's; with its stereo stage's snippet unless the plan leaves layers out.
  SinglePass(const Inputs& inputs, const StereoPlan& plan, const CastKernels& kernels);

  /// Empty: the volume is too near for the layers in this frame, which must be cast twice; nothing was done.
  std::optional<JobOutcome> render(const Pose& world_from_head, const EyePair& into);

  /// How many frames were cast twice and why; "" if none.
  std::string note() const;

 private:
  const gpu::Device& device_;
  const Headset& headset_;
  const SceneOnDevice& scene_;
  VolumePlacement placement_;
  CastPipeline pipeline_;
  StereoLayers layers_;
  std::vector<gpu::Binding> bindings_;
  gpu::CommandList commands_;
  std::int64_t frames_ = 0, cast_twice_ = 0;
};

}  // namespace brace
