#include "hmd_sim/kalman_predictor.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "hmd_sim/tracker.hpp"

namespace brace::sim {
namespace {

using Matrix = KalmanCovariance;

// A first reading says nothing of rates: wider than any head.
constexpr double kStartRate = 20.0;
constexpr double kStartAccelerationFactor = 4.0;  // times the model's
constexpr double kPartsMax = 128.0;               // that a step much longer than tau is cut into

Matrix product(const Matrix& a, const Matrix& b, bool b_transposed = false) {
  Matrix c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k)
        c[i][j] += a[i][k] * (b_transposed ? b[j][k] : b[k][j]);
    }
  }
  return c;
}

/// Covariance that white jerk adds in dt: the integral of f f^T, f the response to a unit of acceleration.
void add_manoeuvres(Matrix& covariance, double dt_s, double tau_s, double sigma) {
  // Gauss-Legendre, exact up to degree 9: errors below 1e-9 for dt up to tau.
  constexpr std::array<double, 5> nodes{0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842,
                                        0.953089922969332};
  constexpr std::array<double, 5> weights{0.118463442528095, 0.239314335249683, 0.284444444444444,
                                          0.239314335249683, 0.118463442528095};
  const double intensity = 2.0 * sigma * sigma / tau_s;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const SingerStep step = singer_step(nodes[n] * dt_s, tau_s);
    const std::array<double, 3> f{step.acceleration_to_angle, step.acceleration_to_rate,
                                  step.acceleration_kept};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        covariance[i][j] += intensity * weights[n] * dt_s * f[i] * f[j];
    }
  }
}

Matrix start_covariance(double noise, double acceleration) {
  const double a = kStartAccelerationFactor * acceleration;
  return {{{noise * noise, 0, 0}, {0, kStartRate * kStartRate, 0}, {0, 0, a * a}}};
}

/// The gain of a reading of the angle, and the covariance after it in Joseph's form, which stays symmetric
/// and positive whatever the rounding.
std::array<double, 3> gain_and_update(Matrix& p, double noise) {
  // Never without noise: two readings would make the covariance singular.
  const double r = std::max(noise * noise, 1e-18);
  const double s = p[0][0] + r;
  const std::array<double, 3> k{p[0][0] / s, p[1][0] / s, p[2][0] / s};
  const Matrix keep{{{1 - k[0], 0, 0}, {-k[1], 1, 0}, {-k[2], 0, 1}}};
  p = product(product(keep, p), keep, true);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      p[i][j] += k[i] * r * k[j];
  }
  return k;
}

glm::dvec3 displacement(const glm::dvec3& rate, const glm::dvec3& acceleration, const SingerStep& step) {
  return step.rate_to_angle * rate + step.acceleration_to_angle * acceleration;
}

double seconds(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

}  // namespace

SingerStep singer_step(double dt_s, double tau_s) {
  const double u = dt_s / tau_s;
  const double lost = -std::expm1(-u);
  // u - lost cancels for small u: its series there.
  const double second = std::abs(u) < 1e-2
                            ? u * u * (0.5 - u * (1.0 / 6 - u * (1.0 / 24 - u * (1.0 / 120 - u / 720))))
                            : u - lost;
  return {dt_s, tau_s * tau_s * second, tau_s * lost, 1.0 - lost};
}

KalmanCovariance propagated(const KalmanCovariance& covariance, double dt_s, double tau_s, double sigma) {
  const double parts = std::clamp(std::ceil(dt_s / tau_s), 1.0, kPartsMax);
  const SingerStep step = singer_step(dt_s / parts, tau_s);
  const Matrix f{{{1, step.rate_to_angle, step.acceleration_to_angle},
                  {0, 1, step.acceleration_to_rate},
                  {0, 0, step.acceleration_kept}}};
  Matrix next = covariance;
  for (int part = 0; part < static_cast<int>(parts); ++part) {
    next = product(product(f, next), f, true);
    add_manoeuvres(next, dt_s / parts, tau_s, sigma);
  }
  return next;
}

void KalmanPredictor::start(const brace_tracker_sample& reading) {
  KalmanEstimate& estimate = estimate_.emplace();
  estimate.time_ns = reading.time_ns;
  estimate.pose = from_abi(reading.world_from_head);
  estimate.turn.covariance =
      start_covariance(model_.orientation_noise_rad, model_.angular_acceleration_rad_s2);
  estimate.shift.covariance = start_covariance(model_.position_noise_m, model_.linear_acceleration_m_s2);
}

void KalmanPredictor::advance(std::int64_t time_ns) {
  const double dt_s = seconds(time_ns - estimate_->time_ns);
  const SingerStep step = singer_step(dt_s, model_.manoeuvre_time_s);
  const auto advance_axes = [&](KalmanAxes& axes, double sigma) {
    const glm::dvec3 way = displacement(axes.rate, axes.acceleration, step);
    axes.rate += step.acceleration_to_rate * axes.acceleration;
    axes.acceleration *= step.acceleration_kept;
    axes.covariance = propagated(axes.covariance, dt_s, model_.manoeuvre_time_s, sigma);
    return way;
  };
  const glm::dvec3 turn_rad = advance_axes(estimate_->turn, model_.angular_acceleration_rad_s2);
  const glm::dvec3 shift_m = advance_axes(estimate_->shift, model_.linear_acceleration_m_s2);
  estimate_->pose = moved(estimate_->pose, turn_rad, shift_m);
  estimate_->time_ns = time_ns;
}

void KalmanPredictor::correct(const brace_tracker_sample& reading) {
  const Pose read = from_abi(reading.world_from_head);
  const auto correct_axes = [](KalmanAxes& axes, double noise, const glm::dvec3& error) {
    const std::array<double, 3> gain = gain_and_update(axes.covariance, noise);
    axes.rate += gain[1] * error;
    axes.acceleration += gain[2] * error;
    return gain[0] * error;
  };
  const glm::dvec3 turn_rad =
      correct_axes(estimate_->turn, model_.orientation_noise_rad,
                   quat_log(glm::normalize(glm::conjugate(estimate_->pose.orientation) * read.orientation)));
  const glm::dvec3 shift_m =
      correct_axes(estimate_->shift, model_.position_noise_m, read.position - estimate_->pose.position);
  estimate_->pose = moved(estimate_->pose, turn_rad, shift_m);
}

Pose KalmanPredictor::predict(std::span<const brace_tracker_sample> history, SimTime target) {
  BRACE_CHECK(!history.empty());
  if (estimate_ && history.back().time_ns < estimate_->time_ns) estimate_.reset();
  for (const brace_tracker_sample& reading : history) {
    if (estimate_ && reading.time_ns <= estimate_->time_ns) continue;
    if (!estimate_ || reading.time_ns - estimate_->time_ns > to_ns(model_.gap_max)) {
      start(reading);
      continue;
    }
    advance(reading.time_ns);
    correct(reading);
  }
  // Backwards the acceleration would have to grow: the rate alone.
  const double dt_s = seconds(to_ns(target) - estimate_->time_ns);
  const SingerStep step = dt_s < 0 ? SingerStep{dt_s, 0, 0, 1} : singer_step(dt_s, model_.manoeuvre_time_s);
  return moved(estimate_->pose, displacement(estimate_->turn.rate, estimate_->turn.acceleration, step),
               displacement(estimate_->shift.rate, estimate_->shift.acceleration, step));
}

}  // namespace brace::sim
