#include "hmd_sim/predictors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "hmd_sim/percentile.hpp"

namespace brace::sim {
namespace {

glm::dvec3 vector_of(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

double seconds_after(const brace_tracker_sample& sample, SimTime time) {
  return static_cast<double>(to_ns(time) - sample.time_ns) * 1e-9;
}

double seconds_between(const brace_tracker_sample& a, const brace_tracker_sample& b) {
  return static_cast<double>(b.time_ns - a.time_ns) * 1e-9;
}

// v(t) = v0 + a t, t from the newest reading on.
struct LinearVelocity {
  glm::dvec3 v0{0.0}, a{0.0};
};

// Least squares over the readings' velocities. Each is a difference to the reading before it, so it belongs
// to the middle between the two; the first one's interval is taken to be like the second's.
LinearVelocity fit(std::span<const brace_tracker_sample> history,
                   const double (brace_tracker_sample::*velocity)[3]) {
  const auto count = static_cast<double>(history.size());
  const auto time_of = [&](std::size_t i) {
    const std::size_t k = std::max<std::size_t>(i, 1);
    return -seconds_between(history[i], history.back()) - 0.5 * seconds_between(history[k - 1], history[k]);
  };
  double mean_t = 0.0;
  glm::dvec3 mean_v(0.0);
  for (std::size_t i = 0; i < history.size(); ++i) {
    mean_t += time_of(i) / count;
    mean_v += vector_of(history[i].*velocity) / count;
  }
  double tt = 0.0;
  glm::dvec3 tv(0.0);
  for (std::size_t i = 0; i < history.size(); ++i) {
    tt += (time_of(i) - mean_t) * (time_of(i) - mean_t);
    tv += (time_of(i) - mean_t) * (vector_of(history[i].*velocity) - mean_v);
  }
  const glm::dvec3 a = tv / tt;
  return {mean_v - a * mean_t, a};
}

// Integral of the velocity over dt, the acceleration held for at most `horizon_s`.
glm::dvec3 displacement(const LinearVelocity& velocity, double dt, double horizon_s) {
  const double held = std::clamp(dt, -horizon_s, horizon_s);
  return velocity.v0 * dt + velocity.a * (0.5 * held * held + held * (dt - held));
}

}  // namespace

Pose predict_none(std::span<const brace_tracker_sample> history, SimTime) {
  BRACE_CHECK(!history.empty());
  return from_abi(history.back().world_from_head);
}

Pose predict_constant_rate(std::span<const brace_tracker_sample> history, SimTime target) {
  BRACE_CHECK(!history.empty());
  const brace_tracker_sample& newest = history.back();
  const double dt = seconds_after(newest, target);
  return moved(from_abi(newest.world_from_head), vector_of(newest.angular_velocity_rad_s) * dt,
               vector_of(newest.linear_velocity_m_s) * dt);
}

Pose predict_constant_acceleration(std::span<const brace_tracker_sample> history, SimTime target) {
  return predict_constant_acceleration(history, target, AccelerationLimits{});
}

Pose predict_constant_acceleration(std::span<const brace_tracker_sample> history, SimTime target,
                                   const AccelerationLimits& limits) {
  BRACE_CHECK(!history.empty());
  // The trace's first reading has no velocity; older than the newest three adds lag, not knowledge.
  if (history.size() < 3) return predict_constant_rate(history, target);
  const auto recent = history.last(3);
  const LinearVelocity turn = fit(recent, &brace_tracker_sample::angular_velocity_rad_s);
  const LinearVelocity shift = fit(recent, &brace_tracker_sample::linear_velocity_m_s);
  // A reversal or a glitch would be carried on for the whole horizon: fall back.
  if (glm::length(turn.a) > limits.angular_rad_s2 || glm::length(shift.a) > limits.linear_m_s2) {
    return predict_constant_rate(history, target);
  }
  const double dt = seconds_after(history.back(), target);
  const double horizon_s = to_s(limits.horizon);
  return moved(from_abi(history.back().world_from_head), displacement(turn, dt, horizon_s),
               displacement(shift, dt, horizon_s));
}

std::vector<PredictionError> prediction_errors(const PoseTrace& truth, Tracker& tracker,
                                               PredictFunction predict, std::span<const SimDuration> horizons,
                                               SimDuration step) {
  BRACE_CHECK(step > SimDuration(0));
  std::vector<std::vector<double>> angles_deg(horizons.size()), positions_mm(horizons.size());
  std::size_t hint = 0;
  for (SimTime now = truth.begin_time(); now <= truth.end_time(); now += step) {
    const auto history = tracker.history(now);
    for (std::size_t i = 0; i < horizons.size(); ++i) {
      const SimTime target = now + horizons[i];
      if (!truth.valid_at(target, hint)) continue;
      const Pose predicted = predict(history, target);
      const Pose real = truth.at(target, tracker.interpolation(), hint);
      angles_deg[i].push_back(angle_between_rad(predicted.orientation, real.orientation) *
                              (180.0 / std::numbers::pi));
      positions_mm[i].push_back(glm::length(predicted.position - real.position) * 1e3);
    }
  }
  std::vector<PredictionError> errors;
  for (std::size_t i = 0; i < horizons.size(); ++i) {
    const std::size_t count = angles_deg[i].size();
    const Spread angle = spread_of(std::move(angles_deg[i])),
                 position = spread_of(std::move(positions_mm[i]));
    errors.push_back({horizons[i],
                      count,
                      {angle.mean, angle.p95, angle.max},
                      {position.mean, position.p95, position.max}});
  }
  return errors;
}

}  // namespace brace::sim
