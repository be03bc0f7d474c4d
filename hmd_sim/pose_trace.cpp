#include "hmd_sim/pose_trace.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "hmd_sim/rotation.hpp"

namespace brace::sim {
namespace {

double seconds_between(SimTime a, SimTime b) {
  return to_s(b - a);
}

void check_pose(const std::string& name, std::size_t index, const TimedPose& pose) {
  const glm::dquat& q = pose.world_from_head.orientation;
  const glm::dvec3& p = pose.world_from_head.position;
  const double norm = std::sqrt(glm::dot(q, q));
  if (!std::isfinite(norm) || !std::isfinite(glm::dot(p, p))) {
    throw input_error("trace '{}': pose {} is not finite", name, index);
  }
  if (std::abs(norm - 1.0) > 1e-6) {
    throw input_error("trace '{}': pose {} has a quaternion of length {}, not 1", name, index, norm);
  }
}

void check_neighbours(const std::string& name, std::size_t index, const TimedPose& a, const TimedPose& b) {
  if (b.time <= a.time) {
    throw input_error("trace '{}': pose {} at {} ns is not later than the one before it", name, index,
                      to_ns(b.time));
  }
  if (glm::dot(a.world_from_head.orientation, b.world_from_head.orientation) < 0.0) {
    throw input_error("trace '{}': the quaternion of pose {} has the opposite sign of its neighbour", name,
                      index);
  }
}

bool is_lost(const glm::dvec3& gaze) {
  return std::isnan(gaze.x + gaze.y + gaze.z);
}

bool is_gap(const TimedPose& a, const TimedPose& b) {
  return b.time - a.time > trace_gap;
}

// Index i with times i <= t < i + 1, in 0 .. size - 2; the caller has clamped t to the trace.
std::size_t find_segment(const std::vector<TimedPose>& poses, SimTime time, std::size_t hint) {
  const std::size_t last = poses.size() - 2;
  std::size_t i = std::min(hint, last);
  constexpr int walk_limit = 16;  // nearer than this a walk beats a search
  for (int step = 0; step < walk_limit; ++step) {
    if (time < poses[i].time) {
      if (i == 0) return 0;
      --i;
    } else if (i < last && time >= poses[i + 1].time) {
      ++i;
    } else {
      return i;
    }
  }
  const auto after = std::upper_bound(poses.begin(), poses.end(), time,
                                      [](SimTime t, const TimedPose& pose) { return t < pose.time; });
  if (after == poses.begin()) return 0;
  return std::min(static_cast<std::size_t>(after - poses.begin()) - 1, last);
}

constexpr std::size_t stencil_points =
    5;  // points of a rate's stencil: a rate of order 4, so that Hermite keeps its 4

// The consecutive poses around `knot` that share its gap-free run, at most stencil_points of them, as centred
// as possible: [first, last].
struct Window {
  std::size_t first, last;
};

Window stencil_window(const std::vector<TimedPose>& poses, std::size_t knot) {
  std::size_t first = knot, last = knot;
  const std::size_t reach = stencil_points - 1;
  while (first > 0 && knot - first < reach && !is_gap(poses[first - 1], poses[first]))
    --first;
  while (last + 1 < poses.size() && last - knot < reach && !is_gap(poses[last], poses[last + 1]))
    ++last;
  while (last - first > reach) {
    if (knot - first > last - knot) {
      ++first;
    } else {
      --last;
    }
  }
  return {first, last};
}

// Derivative at `knot` of the polynomial through the window's poses, in the chart q_knot^-1 q, whose rate at
// its own centre is the body rate. `knot` itself is the chart's zero and drops out of the sum.
PoseTrace::Rates rates_at(const std::vector<TimedPose>& poses, std::size_t knot) {
  const Window window = stencil_window(poses, knot);
  const auto x = [&](std::size_t j) { return seconds_between(poses[knot].time, poses[j].time); };
  const Pose& centre = poses[knot].world_from_head;
  PoseTrace::Rates rates;
  for (std::size_t j = window.first; j <= window.last; ++j) {
    if (j == knot) continue;
    double weight = 1.0 / x(j);
    for (std::size_t m = window.first; m <= window.last; ++m) {
      if (m != knot && m != j) weight *= x(m) / (x(m) - x(j));
    }
    const Pose& pose = poses[j].world_from_head;
    rates.angular_rad_s += weight * turn_between(centre.orientation, pose.orientation);
    rates.linear_m_s += weight * (pose.position - centre.position);
  }
  return rates;
}

template <typename Vector>
Vector hermite(double s, double h, Vector from, Vector from_rate, Vector to, Vector to_rate) {
  const double s2 = s * s, s3 = s2 * s;
  return from * (2 * s3 - 3 * s2 + 1) + from_rate * (h * (s3 - 2 * s2 + s)) + to * (3 * s2 - 2 * s3) +
         to_rate * (h * (s3 - s2));
}

}  // namespace

PoseTrace::PoseTrace(std::string name, std::vector<TimedPose> poses, std::vector<glm::dvec3> gaze)
    : name_(std::move(name)), poses_(std::move(poses)), gaze_(std::move(gaze)) {
  if (poses_.size() < 2) {
    throw input_error("trace '{}': has {} pose{}; at least two are needed", name_, poses_.size(),
                      poses_.size() == 1 ? "" : "s");
  }
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    check_pose(name_, i, poses_[i]);
    if (i > 0) check_neighbours(name_, i, poses_[i - 1], poses_[i]);
  }
  rates_.reserve(poses_.size());
  for (std::size_t i = 0; i < poses_.size(); ++i)
    rates_.push_back(rates_at(poses_, i));
  hold_gaze();
}

void PoseTrace::hold_gaze() {
  if (gaze_.empty()) return;
  if (gaze_.size() != poses_.size()) {
    throw input_error("trace '{}': has {} gaze readings for {} poses; one for each is wanted", name_,
                      gaze_.size(), poses_.size());
  }
  glm::dvec3 last = straight_ahead;
  for (std::size_t i = 0; i < gaze_.size(); ++i) {
    if (!is_lost(gaze_[i])) {
      if (!(std::abs(glm::length(gaze_[i]) - 1.0) <= 1e-6) || !(gaze_[i].z < 0.0)) {
        throw input_error("trace '{}': the gaze of pose {} is no unit vector that looks ahead (z < 0)", name_,
                          i);
      }
      last = gaze_[i];
    }
    held_gaze_.push_back(last);
  }
}

glm::dvec3 PoseTrace::gaze_at(SimTime time, std::size_t& hint) const {
  if (!has_gaze()) return straight_ahead;
  if (time <= begin_time()) return held_gaze_.front();
  if (time >= end_time()) return held_gaze_.back();
  const std::size_t i = hint = find_segment(poses_, time, hint);
  const TimedPose &a = poses_[i], &b = poses_[i + 1];
  if (is_lost(gaze_[i]) || is_lost(gaze_[i + 1]) || is_gap(a, b)) return held_gaze_[i];
  const double s = static_cast<double>(to_ns(time - a.time)) / static_cast<double>(to_ns(b.time - a.time));
  const glm::dvec3 axis = glm::cross(gaze_[i], gaze_[i + 1]);
  const double sine = glm::length(axis);
  if (sine == 0.0) return gaze_[i];  // no turn: opposite gazes cannot be, both look ahead
  const double angle_rad = std::atan2(sine, glm::dot(gaze_[i], gaze_[i + 1]));
  return glm::normalize(quat_exp(axis * (s * angle_rad / sine)) * gaze_[i]);
}

// Hermite in the log chart at the segment's first pose; the end's body rate is mapped into that chart.
Pose PoseTrace::hermite_pose(std::size_t i, double s) const {
  const Pose& a = poses_[i].world_from_head;
  const Pose& b = poses_[i + 1].world_from_head;
  const double h = seconds_between(poses_[i].time, poses_[i + 1].time);
  const Rates &rate_a = rates_[i], &rate_b = rates_[i + 1];
  const glm::dvec3 turn = turn_between(a.orientation, b.orientation);
  const glm::dvec3 chart = hermite(s, h, glm::dvec3(0.0), rate_a.angular_rad_s, turn,
                                   chart_rate_from_body_rate(turn, rate_b.angular_rad_s));
  return {glm::normalize(a.orientation * quat_exp(chart)),
          hermite(s, h, a.position, rate_a.linear_m_s, b.position, rate_b.linear_m_s)};
}

bool PoseTrace::valid_at(SimTime time) const {
  std::size_t hint = poses_.size();
  return valid_at(time, hint);
}

bool PoseTrace::valid_at(SimTime time, std::size_t& hint) const {
  if (time < begin_time() || time > end_time()) return false;
  hint = find_segment(poses_, time, hint);
  const bool on_pose = time == poses_[hint].time || time == poses_[hint + 1].time;
  return on_pose || !is_gap(poses_[hint], poses_[hint + 1]);
}

Pose PoseTrace::at(SimTime time, Interpolation interpolation) const {
  // A hint far off makes the search binary.
  std::size_t hint = to_ns(time - begin_time()) > to_ns(end_time() - begin_time()) / 2 ? poses_.size() : 0;
  return at(time, interpolation, hint);
}

Pose PoseTrace::at(SimTime time, Interpolation interpolation, std::size_t& hint) const {
  if (time <= begin_time()) return poses_.front().world_from_head;
  if (time >= end_time()) return poses_.back().world_from_head;
  const std::size_t i = hint = find_segment(poses_, time, hint);
  const TimedPose& a = poses_[i];
  const TimedPose& b = poses_[i + 1];
  if (time == a.time || is_gap(a, b)) return a.world_from_head;
  const double s = static_cast<double>(to_ns(time - a.time)) / static_cast<double>(to_ns(b.time - a.time));
  if (interpolation == Interpolation::hermite) return hermite_pose(i, s);
  return {slerp_near(a.world_from_head.orientation, b.world_from_head.orientation, s),
          a.world_from_head.position * (1.0 - s) + b.world_from_head.position * s};
}

}  // namespace brace::sim
