#pragma once

#include <vector>

#include "runtime/frame/frame_loop.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/report/report_input.hpp"

namespace brace {

// What a session says of a run before it has begun.

std::vector<StageChoice> stage_choices(const Session& session);

/// What the run does without, and why.
std::vector<LeftOut> left_out(const Session& session, const Headset& headset);

/// Whether a warp goes by the lines of the scan-out: its parameter scan_out is "lines".
bool warps_by_line(const PipelineStage& warp);

/// Whether the cells of an eye frame are cast from poses of their own: schedule/chunked with poses = "cell".
bool cells_have_poses(const PipelineStage& schedule);

/// What a warp stage takes from the pose latched for it: a manifest's inputs say so, a shared library's gets
/// all.
WarpPose warp_pose_of(const PipelineStage& warp);

}  // namespace brace
