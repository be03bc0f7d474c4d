#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.hpp"
#include "base/time.hpp"
#include "hmd_sim/pose_trace.hpp"
#include "hmd_sim/tracker.hpp"

namespace brace {

/// The head of a run: where it truly is, and what the tracker has told of it. Time 0 of the run is `start`,
/// a time of the trace; times given and returned are run times.
///
/// A looping trace starts again at its begin after its last pose, without end. At the seam the true pose
/// jumps unless the trace is periodic, and tracking restarts: predictors see readings of the present turn
/// only, and the readings' noise is that of the first turn.
class HeadMotion {
 public:
  /// Keeps a reference to the trace. Throws input_error if `start` lies outside the trace, or for a looping
  /// trace of one pose.
  HeadMotion(const sim::PoseTrace& trace, sim::Interpolation interpolation, const sim::TrackerModel& tracker,
             std::uint64_t seed, bool loop, SimTime start);

  /// The run time after which there are no true poses; SimTime::max() if looping.
  SimTime end_time() const;
  /// False in a gap of the trace and outside it.
  bool valid_at(SimTime time);
  Pose true_pose(SimTime time);
  /// Where the eyes look, in the head frame: PoseTrace::gaze_at.
  glm::dvec3 true_gaze(SimTime time);
  /// The tracker's readings known at `now`, oldest first, never empty. Valid until the next call.
  std::span<const brace_tracker_sample> readings(SimTime now);

 private:
  struct Folded {
    SimTime trace_time;
    SimDuration turn_begin;  // run time minus trace time
  };
  Folded fold(SimTime run_time) const;

  const sim::PoseTrace& trace_;
  sim::Interpolation interpolation_;
  sim::Tracker tracker_;
  bool loop_;
  SimDuration run_from_trace_;  // run time = trace time + this, in the first turn
  std::size_t hint_ = 0;
  std::vector<brace_tracker_sample> readings_;
};

}  // namespace brace
