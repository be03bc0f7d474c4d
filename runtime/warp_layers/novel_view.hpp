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

/// Whether its layers are equal shares of what a ray's opacity will be: the ray is cast before to know it.
bool layers_of_equal_shares(const PipelineStage& warp);

/// Where layers are bound in the cast kernel: 16 bytes times the layers per ray.
gpu::Binding layers_binding(const gpu::Buffer& layers);
/// Where the closing kernel writes which ray's layers stand for a pixel.
gpu::Binding layer_rays_binding(const EyeTarget& target);

/// The eye that layers were cast from, with the grid of its rays: one per pixel, and some beside the picture.
struct LayerSource {
  const gpu::Buffer& layers;
  EyeView eye;
  RayGrid rays;  // a ray per pixel of it, or an entry of the table
  const gpu::Buffer* ray_of_pixel =
      nullptr;  // the table, where the layers are not in the order of the pixels
};
/// Rays of an eye's own pixels.
LayerSource layer_source(const EyeTarget& target, const EyeView& eye);

/// One eye's picture from another place, out of the layers that were cast with its eye frame (Lochmann et al.
/// 2014; Buchacher 2017, Algorithms 7 and 8). The device must outlive it; one picture at a time.
class NovelView {
 public:
  struct Folders {
    std::filesystem::path glsl, kernels;  // of brace/*.glsl and of novel_view.comp
  };
  /// `stage`: with the parameters of warp/volumetric or stereo/novel_view.
  /// `by_ray`: its sources have tables from pixels to rays.
  NovelView(const gpu::Device& device, const PipelineStage& stage, const Folders& folders,
            bool by_ray = false, bool marks_holes = false);

  /// The volume's box.
  struct Box {
    Pose world_from_volume;  // of its centre
    std::array<double, 3> edges_m{};
  };
  /// Records what an eye sees, image and depth, after a barrier and with one behind. One picture at a time:
  /// what was recorded before must be done, it reads the same parameters.
  /// `holes`: with marks_holes, a uint per pixel, 1 where what it shows is not known to the end.
  void record(gpu::CommandList& commands, const LayerSource& from, const EyeView& eye, const EyeTarget& into,
              const Box& box, const gpu::Buffer* holes = nullptr);

  /// For stages with scan_out = "lines": where the eye is at the first and the last line, and how far the
  /// scan-out is at each pixel (a float).
  struct Scan {
    Pose world_from_first_line, world_from_last_line;  // of the eye
    const gpu::Buffer& fractions;
  };
  void record_by_line(gpu::CommandList& commands, const LayerSource& from, const EyeView& eye,
                      const Scan& scan, const EyeTarget& into, const Box& box);

  /// Since the last reset; after the work is done.
  struct Counts {
    std::uint64_t segments = 0;   // of rays, each with a look into a pixel's layers
    std::uint64_t uncovered = 0;  // pixels whose ray leaves the old picture within the volume's box
    std::uint64_t filled = 0;     // pixels that show what was extended behind a stopped ray
  };
  Counts counted() const;
  void reset_counters() const;

 private:
  void dispatch(gpu::CommandList& commands, const LayerSource& from, const EyeView& eye,
                const EyeTarget& into, const gpu::Binding* more);

  const gpu::Device& device_;
  gpu::ComputePipeline pipeline_;
  gpu::Buffer params_, counters_;
};

}  // namespace brace
