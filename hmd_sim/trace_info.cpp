#include "hmd_sim/trace_info.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "hmd_sim/percentile.hpp"

namespace brace::sim {

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
  return info;
}

PoseTrace shifted_to(const PoseTrace& trace, SimTime begin) {
  std::vector<TimedPose> poses = trace.poses();
  const SimDuration shift = begin - trace.begin_time();
  for (TimedPose& pose : poses)
    pose.time += shift;
  return PoseTrace(trace.name(), std::move(poses));
}

}  // namespace brace::sim
