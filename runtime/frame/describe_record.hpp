#pragma once

#include "runtime/frame/gaze_motion.hpp"
#include "runtime/metrics/frame_record.hpp"

namespace brace {

/// The errors of a shown head pose against the true one.
void describe_error(FrameRecord& record, const Pose& shown, const Pose& truth);

/// The true gaze at `photon`, and how far from it `known` is, what the eye frame was made for. Returns the
/// truth; straight ahead, with nothing recorded, where `gaze` is null.
glm::dvec3 describe_gaze(FrameRecord& record, GazeMotion* gaze, const glm::dvec3& known, SimTime photon);

}  // namespace brace
