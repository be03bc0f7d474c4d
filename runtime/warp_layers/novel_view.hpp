#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "runtime/gpu/pipeline.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/raycast/cast_pipeline.hpp"

namespace brace {

/// Whether a warp stage asks the raycaster for layers (its inputs name "layers"): warp/volumetric.
bool takes_layers(const PipelineStage& warp);

/// Layers per pixel that it asks for; 0 without.
int layer_count_of(const PipelineStage& warp);

/// Where the layers of a target are bound in the cast kernel.
gpu::Binding layers_binding(const EyeTarget& target);

/// One eye's picture from another place, out of the layers that were cast with its eye frame (Lochmann et al.
/// 2014; Buchacher 2017, Algorithms 7 and 8). The device must outlive it; one picture at a time.
class NovelView {
 public:
  struct Folders {
    std::filesystem::path glsl, kernels;  // of brace/*.glsl and of novel_view.comp
  };
  /// `warp`: a stage with the parameters of warp/volumetric.
  NovelView(const gpu::Device& device, const PipelineStage& warp, int width_px, int height_px,
            const Folders& folders);

  /// The volume's box.
  struct Box {
    Pose world_from_volume;  // of its centre
    std::array<double, 3> edges_m{};
  };
  /// Records the picture of an eye that was cast as `cast` and looks from `world_from_eye` now, after a
  /// barrier and with one behind. Nothing submitted may still read the last picture.
  void record(gpu::CommandList& commands, const EyeTarget& layers, const EyeView& cast,
              const Pose& world_from_eye, const Box& box);

  /// R32_UINT texels, premultiplied RGBA8, of the eye frame's size.
  const gpu::TexelBuffer& picture() const { return texels_; }
  const gpu::Buffer& image() const { return image_; }

  /// Since the last reset; after the work is done.
  struct Counts {
    std::uint64_t segments = 0;   // of rays, each with a look into a pixel's layers
    std::uint64_t uncovered = 0;  // pixels whose ray leaves the old picture within the volume's box
    std::uint64_t filled = 0;     // pixels that show what was extended behind a stopped ray
  };
  Counts counted() const;
  void reset_counters() const;

 private:
  const gpu::Device& device_;
  int width_px_, height_px_;
  gpu::ComputePipeline pipeline_;
  gpu::Buffer params_, image_, counters_;
  gpu::TexelBuffer texels_;
};

}  // namespace brace
