#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "runtime/host/stage_registry.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/stereo/stereo_plan.hpp"

namespace brace {

/// The settings that a stage with the parameters of stereo/layers asks for.
StereoSettings stereo_settings(const PipelineStage& stage);

/// Single-pass stereo by re-projection layers on the device: holds the layers and the first eye's rays, and
/// composes the second eye's picture. The device must outlive it; one frame at a time.
class StereoLayers {
 public:
  struct Folders {
    std::filesystem::path glsl, kernels;  // of brace/*.glsl and of stereo/*.comp
  };

  StereoLayers(const gpu::Device& device, const PipelineStage& stage, const StereoPlan& plan,
               const Folders& folders);

  const StereoPlan& plan() const { return plan_; }
  /// Of the grid; empty with rays/mab, which has its own.
  const RayBuffers& rays() const { return rays_; }

  /// What the stage's snippet binds in the cast kernel.
  std::span<const gpu::Binding> bindings() const { return bindings_; }

  /// Sets up the coming frame; nothing submitted may be waiting. `reference`: where the rays are cast from.
  /// False: the volume is too near for the layers (or around the eyes) and the frame must be cast twice.
  bool begin_frame(const EyeView& reference, const VolumeInfo& volume, const VolumePlacement& placement);

  /// The rays of this frame; `grid` for CastPipeline::set_eye of the reference. Not with rays/mab.
  const CastArea& ray_area() const { return area_; }
  RayGrid grid() const { return {plan_.across, plan_.down, plan_.margins.left, plan_.margins.top}; }

  /// The picture of an eye, or with rays/mab what the texels of its atlas show.
  struct Composed {
    const EyeTarget& target;            // its parameters are set
    const gpu::Buffer* holes;           // see below; null without
    const RayBuffers* atlas = nullptr;  // with rays/mab: the eye's rays, whose results it becomes instead …
    RayGrid grid = {};
    std::span<const gpu::Binding> of_atlas = {};
    const gpu::Buffer *colours = nullptr,
                      *depths_m = nullptr;  // … or that go here, a vec4 and a float per ray
  };
  /// Records, after a barrier, what the eye sees whose pictures come `eye`-th in the plan. Its `holes`: a
  /// uint per pixel (per ray of an atlas), set to 1 where what it shows is not known to the end; needed where
  /// plan().settings.fresh_rays asks for them and layers are not left out.
  void record_composed(gpu::CommandList& commands, std::size_t eye, const Composed& into) const;

  /// Since the last reset; after the work is done.
  struct Counts {
    std::uint32_t written = 0;  // texels of layers, by kernels that count
    std::uint32_t read = 0;     // by the composition
  };
  Counts counted() const;
  void reset_counters() const;

 private:
  void clear_ranges();
  bool fits(DepthRange depths);
  std::size_t pictures_per_eye() const { return static_cast<std::size_t>(std::max(plan_.levels, 1)); }

  const gpu::Device& device_;
  StereoPlan plan_;
  RayBuffers rays_;
  gpu::Buffer params_, texels_, ranges_, counts_;
  gpu::ComputePipeline second_eye_;
  std::vector<gpu::Binding> bindings_;
  CastArea area_;
  std::uint32_t frame_ = 0;
};

}  // namespace brace
