#pragma once

#include <cstddef>

#include "hmd_sim/pose_trace.hpp"

namespace brace::sim {

/// What `brace trace info` prints. Speeds are differences of neighbouring poses, gaps left out.
struct TraceInfo {
  std::size_t poses = 0;
  double duration_s = 0;
  double rate_hz = 0;  // 1 / median interval
  double interval_ms_min = 0, interval_ms_median = 0, interval_ms_max = 0;
  std::size_t gaps = 0;        // intervals > 50 ms
  std::size_t duplicates = 0;  // neighbours with identical poses
  double angular_speed_deg_s_mean = 0, angular_speed_deg_s_p95 = 0, angular_speed_deg_s_p99 = 0,
         angular_speed_deg_s_max = 0;
  double linear_speed_m_s_mean = 0, linear_speed_m_s_p95 = 0, linear_speed_m_s_p99 = 0,
         linear_speed_m_s_max = 0;
  glm::dvec3 position_min_m{0.0}, position_max_m{0.0};

  /// Of the gaze; zeros without. Speeds between readings that are not lost.
  bool has_gaze = false;
  std::size_t gaze_lost = 0, blinks = 0;  // readings; runs of them
  double gaze_speed_deg_s_mean = 0, gaze_speed_deg_s_p95 = 0, gaze_speed_deg_s_max = 0;
  double gaze_off_deg_mean = 0, gaze_off_deg_max = 0;  // from straight ahead
};

TraceInfo trace_info(const PoseTrace& trace);

/// The same trace with its first pose at `begin`; intervals unchanged.
PoseTrace shifted_to(const PoseTrace& trace, SimTime begin);

}  // namespace brace::sim
