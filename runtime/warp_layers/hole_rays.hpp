#pragma once

#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/warp_layers/novel_view.hpp"

namespace brace {

/// Fresh rays for the pixels of a composed picture that are not known to the end. The device must outlive it.
class HoleRays {
 public:
  /// Whose rays they are: of the picture's pixels, or of an atlas whose texels were composed (rays/mab).
  enum class Of { pixels, atlas };

  /// `kernels`: the session's, without a snippet that emits. `across`, `down`: pixels, or the most rays of
  /// the atlas; `rays` of the resources are as many at least.
  HoleRays(const gpu::Device& device, const CastKernels& kernels, int across, int down,
           const NovelView::Folders& folders, Of of = Of::pixels);

  /// A uint per pixel, or per ray of an atlas: 1 where a fresh ray is wanted.
  const gpu::Buffer& holes() const { return holes_; }
  /// Of an atlas: where what was composed goes, a premultiplied vec4 and a float (metres) per ray.
  const gpu::Buffer& composed_colours() const { return colours_; }
  const gpu::Buffer& composed_depths_m() const { return depths_m_; }

  /// Record, after a barrier, what comes before and after the cast of area() with pipeline(): rays for the
  /// marked pixels alone, and these in `resources.target`, for which CastPipeline::set_eye was called with
  /// grid(); of the marked rays of an atlas, and its closing, after set_eye with the atlas' grid, which
  /// `resources` have.
  void record_opening(gpu::CommandList& commands, const CastPipeline::Resources& resources) const;
  void record_closing(gpu::CommandList& commands, const CastPipeline::Resources& resources) const;
  CastArea area(const CastPipeline::Resources& resources) const;
  const CastPipeline& pipeline() const { return pipeline_; }
  RayGrid grid() const { return {across_, down_}; }

  WorkCounts counted() const { return pipeline_.counted(device_); }
  void reset_counters() const { pipeline_.reset_counters(device_); }

 private:
  void run(gpu::CommandList& commands, const gpu::ComputePipeline& pipeline,
           const CastPipeline::Resources& resources) const;

  const gpu::Device& device_;
  int across_, down_;
  Of of_;
  CastPipeline pipeline_;
  gpu::ComputePipeline mask_, merge_;
  gpu::Buffer holes_, colours_, depths_m_;
};

}  // namespace brace
