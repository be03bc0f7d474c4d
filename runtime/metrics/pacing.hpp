#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/metrics/frame_record.hpp"

namespace brace {

/// Nearest-rank percentiles: the smallest value with at least p % of the values at or below it. All zero if
/// count is 0.
struct Distribution {
  std::int64_t count = 0;
  double mean = 0, p50 = 0, p95 = 0, p99 = 0, max = 0;
};

/// Nearest-rank percentile of ascending values, 0 < percent <= 100. Not empty.
double nearest_rank(std::span<const double> ascending, double percent);

/// Sorts a copy.
Distribution distribution_of(std::vector<double> values);

/// Figures of a run, pure functions of its records (numerics.md, section 7).
///
/// Start-up vsyncs (before the first image) count in `vsyncs` and `startup_vsyncs` alone. Gap vsyncs (the
/// trace has no pose at their photon time) count for misses, but not for latencies, ages and errors: what the
/// head did there is not known.
struct PacingFigures {
  std::int64_t vsyncs = 0;
  std::int64_t startup_vsyncs = 0;
  std::int64_t gap_vsyncs = 0;
  std::int64_t missed_vsyncs = 0;
  double missed_ratio = 0;  // of the vsyncs after start-up
  std::int64_t longest_stale_run = 0;
  std::int64_t stale_runs = 0;
  std::int64_t frames_shown = 0;  // distinct eye frames seen

  Distribution mtp_rotation_ms;
  Distribution mtp_translation_ms;
  Distribution frame_age_ms;
  Distribution angular_error_deg;
  Distribution position_error_mm;

  /// (sim_k - sim_{k-1}) - (disp_k - disp_{k-1}) over successive new eye frames: sim is the photon time the
  /// frame's pose was predicted for, disp the middle photon time at which it was first seen. Blind to clean
  /// drops: read it with missed_ratio.
  Distribution animation_error_abs_ms;

  /// RMS of the second difference of (shown - true) over three successive vsyncs, as an image shift at the
  /// view's centre (yaw and pitch), in degrees; times pixels per degree it is in pixels.
  double judder_rms_deg = 0;
};

PacingFigures pacing_figures(std::span<const FrameRecord> records);

/// Rate of rendered eye frames from the times they were done, ascending. A frame's time is the interval to
/// the frame done before it; all zero for fewer than two frames.
struct FrameRate {
  std::int64_t frames = 0;
  double fps_avg = 0;            // intervals / (last - first)
  double fps_1pct_low = 0;       // 1000 / p99 of the frame times in ms, nearest rank: the one reported
  double fps_1pct_low_mean = 0;  // 1000 / mean of the slowest 1 % (at least one) of the frame times
};
FrameRate frame_rate(std::span<const std::int64_t> done_ns);

}  // namespace brace
