#include "runtime/frame/head_motion.hpp"

#include "base/error.hpp"

namespace brace {

HeadMotion::HeadMotion(const sim::PoseTrace& trace, sim::Interpolation interpolation,
                       const sim::TrackerModel& tracker, std::uint64_t seed, bool loop, SimTime start)
    : trace_(trace),
      interpolation_(interpolation),
      tracker_(trace, tracker, seed, {.interpolation = interpolation}),
      loop_(loop),
      run_from_trace_(-start.time_since_epoch()) {
  if (start < trace.begin_time() || start > trace.end_time()) {
    throw input_error("trace '{}': a start at {:.3f} s lies outside it; it lasts from {:.3f} to {:.3f} s",
                      trace.name(), to_s(start), to_s(trace.begin_time()), to_s(trace.end_time()));
  }
  if (loop && trace.begin_time() == trace.end_time()) {
    throw input_error("trace '{}': one pose cannot be looped; it needs two or more", trace.name());
  }
  readings_.reserve(sim::TrackerHistoryOptions{}.capacity);
}

HeadMotion::Folded HeadMotion::fold(SimTime run_time) const {
  const SimTime unfolded = run_time - run_from_trace_;
  if (!loop_ || unfolded <= trace_.end_time()) return {unfolded, run_from_trace_};
  const SimDuration turn = trace_.end_time() - trace_.begin_time();
  const std::int64_t turns = (unfolded - trace_.begin_time()) / turn;
  return {unfolded - turns * turn, run_from_trace_ + turns * turn};
}

SimTime HeadMotion::end_time() const {
  return loop_ ? SimTime::max() : trace_.end_time() + run_from_trace_;
}

bool HeadMotion::valid_at(SimTime time) {
  return trace_.valid_at(fold(time).trace_time, hint_);
}

Pose HeadMotion::true_pose(SimTime time) {
  return trace_.at(fold(time).trace_time, interpolation_, hint_);
}

glm::dvec3 HeadMotion::true_gaze(SimTime time) {
  return trace_.gaze_at(fold(time).trace_time, hint_);
}

std::span<const brace_tracker_sample> HeadMotion::readings(SimTime now) {
  const Folded folded = fold(now);
  const std::span<const brace_tracker_sample> history = tracker_.history(folded.trace_time);
  readings_.assign(history.begin(), history.end());
  for (brace_tracker_sample& reading : readings_)
    reading.time_ns += to_ns(folded.turn_begin);
  return readings_;
}

}  // namespace brace
