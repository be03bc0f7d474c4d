#pragma once

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

  StereoLayers(const gpu::Device& device, const PipelineStage& stage, const StereoPlan& plan, int width_px,
               int height_px, const Folders& folders);

  const StereoPlan& plan() const { return plan_; }
  const RayBuffers& rays() const { return rays_; }

  /// What the stage's snippet binds in the cast kernel.
  std::span<const gpu::Binding> bindings() const { return bindings_; }

  /// Sets up the coming frame; nothing submitted may be waiting. False: the volume is too near for the layers
  /// (or around the eyes) and the frame must be cast twice.
  bool begin_frame(const EyeViews& eyes, const VolumeInfo& volume, const VolumePlacement& placement);

  /// The rays of this frame; `grid` for CastPipeline::set_eye of the first eye.
  const CastArea& ray_area() const { return area_; }
  RayGrid grid() const { return {plan_.across, plan_.down, plan_.margins.left, plan_.margins.top}; }

  /// Records the second eye's picture, after a barrier. `holes`: a uint per pixel, set to 1 where what it
  /// shows is not known to the end; needed where plan().settings.fresh_rays asks for them and layers are not
  /// left out.
  void record_second_eye(gpu::CommandList& commands, const EyeTarget& first, const EyeTarget& second,
                         const gpu::Buffer* holes) const;

  /// Since the last reset; after the work is done.
  struct Counts {
    std::uint32_t written = 0;  // texels of layers, by kernels that count
    std::uint32_t read = 0;     // by the composition
  };
  Counts counted() const;
  void reset_counters() const;

 private:
  void clear_ranges();

  const gpu::Device& device_;
  StereoPlan plan_;
  int width_px_, height_px_;
  RayBuffers rays_;
  gpu::Buffer params_, texels_, ranges_, counts_;
  gpu::ComputePipeline second_eye_;
  std::vector<gpu::Binding> bindings_;
  CastArea area_;
  std::uint32_t frame_ = 0;
};

}  // namespace brace
