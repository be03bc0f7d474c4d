#pragma once

#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/warp_layers/novel_view.hpp"

namespace brace {

/// Fresh rays for the pixels of a novel view that are not known to the end. The device must outlive it.
class HoleRays {
 public:
  /// `kernels`: the session's, without a snippet that emits. `rays`: of the pictures' pixels at least.
  HoleRays(const gpu::Device& device, const CastKernels& kernels, int width_px, int height_px,
           const NovelView::Folders& folders);

  /// What NovelView::record marks.
  const gpu::Buffer& holes() const { return holes_; }

  /// Records, after a barrier, the cast of the marked pixels into `resources.target`, for which
  /// CastPipeline::set_eye was called with grid().
  void record(gpu::CommandList& commands, const CastPipeline::Resources& resources) const;
  RayGrid grid() const { return {width_px_, height_px_}; }

  WorkCounts counted() const { return pipeline_.counted(device_); }
  void reset_counters() const { pipeline_.reset_counters(device_); }

 private:
  const gpu::Device& device_;
  int width_px_, height_px_;
  CastPipeline pipeline_;
  gpu::ComputePipeline mask_, merge_;
  gpu::Buffer holes_;
};

}  // namespace brace
