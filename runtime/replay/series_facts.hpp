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

/// What a warp stage takes from the pose latched for it: a manifest's inputs say so, a shared library's gets
/// all.
WarpPose warp_pose_of(const PipelineStage& warp);

}  // namespace brace
