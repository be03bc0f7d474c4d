#pragma once

#include <array>
#include <vector>

#include "base/image.hpp"
#include "runtime/display/display_pipeline.hpp"
#include "runtime/frame/frame_work.hpp"
#include "runtime/replay/eye_renderer.hpp"

namespace brace {

/// What the panels of both eyes show, indexed by sim::Eye.
using PanelPair = std::array<ImageRgba8, 2>;

/// The panels of a session's headset behind one warp stage. Device and headset must outlive it.
class PanelDisplay {
 public:
  PanelDisplay(const gpu::Device& device, const Headset& headset, const PipelineStage& warp,
               const std::filesystem::path& data_folder);

  /// Warps, distorts and keeps the panels' pictures: `eyes` were rendered from `render_pose`, the head is now
  /// at `warp_pose`.
  JobOutcome show(const EyePair& eyes, const Pose& render_pose, const Pose& warp_pose);

  /// The panels' pictures after the last show().
  PanelPair read() const;

  /// Work of one show(), known beforehand.
  WorkCounts work() const;

  const LensTraits& lens() const { return lens_; }

 private:
  const gpu::Device& device_;
  const Headset& headset_;
  LensTraits lens_;
  DisplayPipeline pipeline_;
  std::array<PanelTarget, 2> panels_;
  gpu::CommandList commands_;
};

/// One byte per panel pixel of an eye: 1 where the eye sees it.
std::vector<std::uint8_t> visible_pixels(const Headset& headset, sim::Eye eye);

}  // namespace brace
