#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/pose.hpp"
#include "base/time.hpp"
#include "hmd_sim/pose_trace.hpp"
#include "hmd_sim/tracker.hpp"
#include "plugins/abi/brace_stage.h"

namespace brace::sim {

// Pure functions: the head pose at `target` from readings that are not empty, oldest first, with strictly
// increasing times. `target` may lie before the newest reading. They do not allocate. All return a finite
// unit pose for finite input.

Pose predict_none(std::span<const brace_tracker_sample> history, SimTime target);
Pose predict_constant_rate(std::span<const brace_tracker_sample> history, SimTime target);

struct AccelerationLimits {
  double angular_rad_s2 = 120;  // beyond it the acceleration is taken for noise or a reversal …
  double linear_m_s2 = 60;      // … and the constant rate is used instead
  SimDuration horizon = std::chrono::milliseconds(60);  // the acceleration is held no longer than this
};

Pose predict_constant_acceleration(std::span<const brace_tracker_sample> history, SimTime target);
Pose predict_constant_acceleration(std::span<const brace_tracker_sample> history, SimTime target,
                                   const AccelerationLimits& limits);

using PredictFunction = std::function<Pose(std::span<const brace_tracker_sample> history, SimTime target)>;

struct ErrorSummary {
  double mean = 0, p95 = 0, max = 0;  // nearest-rank percentile
};

/// Error against the true pose when predicting `horizon` beyond the moment of asking.
struct PredictionError {
  SimDuration horizon;
  std::size_t count = 0;  // moments measured; those whose target the trace does not cover are left out
  ErrorSummary angle_deg;
  ErrorSummary position_mm;
};

/// Asks at every `step` from the trace's begin on, for every horizon.
std::vector<PredictionError> prediction_errors(const PoseTrace& truth, Tracker& tracker,
                                               PredictFunction predict, std::span<const SimDuration> horizons,
                                               SimDuration step);

}  // namespace brace::sim
