#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/time.hpp"
#include "hmd_sim/pose_trace.hpp"
#include "hmd_sim/vsync.hpp"
#include "plugins/abi/brace_stage.h"

namespace brace::sim {

/// What a tracker does to the true pose.
struct TrackerModel {
  Rate rate{1000, 1};
  SimDuration latency{0};            // from a reading's time to its being known
  double position_noise_m = 0;       // standard deviation per axis
  double orientation_noise_rad = 0;  // standard deviation per axis
  double dropout_probability = 0;    // of one reading, 0 .. 1
};

brace_pose to_abi(const Pose& pose);
Pose from_abi(const brace_pose& pose);

struct TrackerHistoryOptions {
  std::size_t capacity = 4;                            // readings kept for predictors, >= 1
  SimDuration spacing = std::chrono::milliseconds(4);  // smallest distance of two kept readings
  Interpolation interpolation = Interpolation::slerp_linear;
};

/// Reads a trace as a tracker would. Reading i is at trace begin + i / rate; its noise and drop-out depend on
/// (seed, i) alone, so what is returned does not depend on when or how often it is asked for. Only readings
/// that are looked at are computed; no allocation after construction. Readings inside a gap of the trace do
/// not exist. Keeps a reference to the trace: the trace must outlive it.
class Tracker {
 public:
  /// Throws input_error for a model out of range: noise and latency >= 0, drop-out probability 0 .. 0.99.
  Tracker(const PoseTrace& trace, const TrackerModel& model, std::uint64_t seed,
          const TrackerHistoryOptions& options = {});

  /// The readings known at `now`, oldest first, the newest last, at most `capacity`, neighbours at least
  /// `spacing` apart. Velocities are the difference to the reading `spacing` before (0 for the trace's
  /// first). Never empty: before the first reading is known it is the first reading (a runtime waits for
  /// tracking). Valid until the next call.
  std::span<const brace_tracker_sample> history(SimTime now);

  /// history(now).back(), at the cost of one reading and its velocity.
  brace_tracker_sample newest(SimTime now);

  const TrackerModel& model() const { return model_; }
  Interpolation interpolation() const { return options_.interpolation; }
  /// Readings computed so far: what a test counts instead of time.
  std::uint64_t readings_computed() const { return readings_computed_; }

 private:
  struct Moment {
    std::int64_t index;
    SimTime time;
  };

  bool dropped(std::int64_t index) const;
  Moment newest_existing(std::int64_t index, std::size_t& hint) const;
  Moment newest_known(SimTime now, std::size_t& hint) const;
  Pose read(const Moment& moment, std::size_t& hint);
  std::span<const brace_tracker_sample> collect(SimTime now, std::size_t wanted);

  const PoseTrace& trace_;
  TrackerModel model_;
  std::uint64_t seed_;
  TrackerHistoryOptions options_;
  VsyncClock clock_;
  std::int64_t stride_;      // readings per spacing
  std::int64_t last_index_;  // of the last reading within the trace
  std::size_t hint_ = 0;     // trace position of the newest reading asked for
  std::uint64_t readings_computed_ = 0;
  std::vector<brace_tracker_sample> samples_;  // filled from the back; the last `collected_` are valid
  std::size_t collected_ = 0;
};

}  // namespace brace::sim
