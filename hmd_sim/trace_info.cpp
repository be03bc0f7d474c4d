#include "hmd_sim/trace_info.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "hmd_sim/percentile.hpp"

namespace brace::sim {

namespace {

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * (180.0 / std::numbers::pi);
}

void add_gaze_info(const PoseTrace& trace, TraceInfo& info) {
  const std::vector<glm::dvec3>& gaze = trace.gaze();
  const auto lost = [&](std::size_t i) { return std::isnan(gaze[i].x); };
  std::vector<double> speed_deg_s, off_deg;
  for (std::size_t i = 0; i < gaze.size(); ++i) {
    if (lost(i)) {
      ++info.gaze_lost;
      if (i == 0 || !lost(i - 1)) ++info.blinks;
      continue;
    }
    off_deg.push_back(angle_deg(straight_ahead, gaze[i]));
    if (i == 0 || lost(i - 1)) continue;
    const SimDuration interval = trace.poses()[i].time - trace.poses()[i - 1].time;
    if (interval <= trace_gap) speed_deg_s.push_back(angle_deg(gaze[i - 1], gaze[i]) / to_s(interval));
  }
  info.has_gaze = true;
  const Spread speed = spread_of(std::move(speed_deg_s)), off = spread_of(std::move(off_deg));
  info.gaze_speed_deg_s_mean = speed.mean;
  info.gaze_speed_deg_s_p95 = speed.p95;
  info.gaze_speed_deg_s_max = speed.max;
  info.gaze_off_deg_mean = off.mean;
  info.gaze_off_deg_max = off.max;
}

}  // namespace

TraceInfo trace_info(const PoseTrace& trace) {
  const std::vector<TimedPose>& poses = trace.poses();
  TraceInfo info;
  info.poses = poses.size();
  info.duration_s = to_s(trace.end_time() - trace.begin_time());
  info.position_min_m = info.position_max_m = poses.front().world_from_head.position;
  std::vector<double> intervals_ms, angular_deg_s, linear_m_s;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose& a = poses[i - 1].world_from_head;
    const Pose& b = poses[i].world_from_head;
    info.position_min_m = glm::min(info.position_min_m, b.position);
    info.position_max_m = glm::max(info.position_max_m, b.position);
    const SimDuration interval = poses[i].time - poses[i - 1].time;
    intervals_ms.push_back(to_s(interval) * 1e3);
    if (a.orientation == b.orientation && a.position == b.position) ++info.duplicates;
    if (interval > trace_gap) {
      ++info.gaps;
      continue;
    }
    angular_deg_s.push_back(angle_between_rad(a.orientation, b.orientation) * (180.0 / std::numbers::pi) /
                            to_s(interval));
    linear_m_s.push_back(glm::length(b.position - a.position) / to_s(interval));
  }
  std::sort(intervals_ms.begin(), intervals_ms.end());
  info.interval_ms_min = intervals_ms.front();
  info.interval_ms_median = nearest_rank(intervals_ms, 0.5);
  info.interval_ms_max = intervals_ms.back();
  info.rate_hz = 1e3 / info.interval_ms_median;
  const Spread angular = spread_of(std::move(angular_deg_s));
  info.angular_speed_deg_s_mean = angular.mean;
  info.angular_speed_deg_s_p95 = angular.p95;
  info.angular_speed_deg_s_p99 = angular.p99;
  info.angular_speed_deg_s_max = angular.max;
  const Spread linear = spread_of(std::move(linear_m_s));
  info.linear_speed_m_s_mean = linear.mean;
  info.linear_speed_m_s_p95 = linear.p95;
  info.linear_speed_m_s_p99 = linear.p99;
  info.linear_speed_m_s_max = linear.max;
  if (trace.has_gaze()) add_gaze_info(trace, info);
  return info;
}

PoseTrace shifted_to(const PoseTrace& trace, SimTime begin) {
  std::vector<TimedPose> poses = trace.poses();
  const SimDuration shift = begin - trace.begin_time();
  for (TimedPose& pose : poses)
    pose.time += shift;
  return PoseTrace(trace.name(), std::move(poses), trace.gaze());
}

}  // namespace brace::sim
