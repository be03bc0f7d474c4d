#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "base/pose.hpp"
#include "base/time.hpp"
#include "plugins/abi/brace_stage.h"

namespace brace::sim {

/// What the filter takes for granted of the head and of the tracker. Standard deviations, per axis.
struct KalmanModel {
  double orientation_noise_rad = 1e-4;                   // of a reading
  double position_noise_m = 1e-4;                        // of a reading
  double angular_acceleration_rad_s2 = 20.0;             // of the head
  double linear_acceleration_m_s2 = 2.0;                 // of the head
  double manoeuvre_time_s = 0.05;                        // after which an acceleration has fallen to 1/e, > 0
  SimDuration gap_max = std::chrono::milliseconds(100);  // no reading for longer: the filter starts anew
};

/// State-estimation error of angle (or place), rate and acceleration, the same for each axis: all noise is
/// isotropic, so the three axes share it.
using KalmanCovariance = std::array<std::array<double, 3>, 3>;

/// What a Singer model does in `dt_s` seconds: acceleration decays by exp(-dt / tau), white jerk drives it.
/// No term cancels at any dt / tau (Singer, Estimating optimal tracking filter performance, 1970).
struct SingerStep {
  double rate_to_angle = 0;          // dt
  double acceleration_to_angle = 0;  // tau^2 (dt/tau - 1 + exp(-dt/tau))
  double acceleration_to_rate = 0;   // tau (1 - exp(-dt/tau))
  double acceleration_kept = 1;      // exp(-dt/tau)
};
SingerStep singer_step(double dt_s, double tau_s);
/// P <- F P F^T + Q for an acceleration of standard deviation `sigma`. Exact within 1e-9 for dt up to 128
/// tau; symmetric and not negative at any.
KalmanCovariance propagated(const KalmanCovariance& covariance, double dt_s, double tau_s, double sigma);

/// Rate, acceleration and the state-estimation error of three axes.
struct KalmanAxes {
  glm::dvec3 rate{0.0}, acceleration{0.0};
  KalmanCovariance covariance{};
};

struct KalmanEstimate {
  std::int64_t time_ns = 0;
  Pose pose;
  KalmanAxes turn, shift;
};

/// An error-state Kalman filter on rotation and position: the estimate itself is a quaternion with rates in
/// the head's frame, the filtered error a rotation vector. It keeps its state between calls: readings that it
/// has seen are passed over, so it must see each head's readings in their order. No allocation.
class KalmanPredictor {
 public:
  explicit KalmanPredictor(const KalmanModel& model = {}) : model_(model) {}

  /// The head pose at `target` from readings that are not empty, oldest first, with strictly increasing
  /// times. Readings older than all that it has seen, or a gap, start it anew. Finite for finite readings.
  Pose predict(std::span<const brace_tracker_sample> history, SimTime target);

 private:
  void start(const brace_tracker_sample& reading);
  void advance(std::int64_t time_ns);
  void correct(const brace_tracker_sample& reading);

  KalmanModel model_;
  std::optional<KalmanEstimate> estimate_;
};

}  // namespace brace::sim
