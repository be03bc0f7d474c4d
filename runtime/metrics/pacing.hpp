#pragma once

#include <array>
#include <cstdint>
#include <optional>
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

/// Figures of a run, functions of its records alone (numerics.md, section 7). Every vsync counts once, also
/// those where the panel repeats an image: its photons are as old as they are.
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

  /// |(sim_k - sim_{k-1}) - (disp_k - disp_{k-1})| over successive new eye frames: sim is the photon time the
  /// frame's pose was predicted for, disp the middle photon time at which it was first seen. Blind to clean
  /// drops: read it with missed_ratio.
  Distribution animation_error_ms;

  /// RMS of the second difference of (shown - true) over three successive vsyncs, as an image shift at the
  /// view's centre (pitch and yaw), in degrees. Times pixels per degree it is in pixels.
  double judder_rms_deg = 0;
};

/// Rate of rendered eye frames from the times they were done. A frame's time is the interval to the frame
/// done before it; all zero for fewer than two frames.
struct FrameRate {
  std::int64_t frames = 0;
  double fps_avg = 0;            // intervals / (last - first)
  double fps_1pct_low = 0;       // 1000 / p99 of the frame times in ms, nearest rank: the one reported
  double fps_1pct_low_mean = 0;  // 1000 / mean of the slowest 1 % (at least one) of the frame times
};

PacingFigures pacing_figures(std::span<const FrameRecord> records);
FrameRate frame_rate(std::span<const std::int64_t> done_ns);  // ascending

/// Values kept one by one: exact.
class ExactValues {
 public:
  void add(double value) { values_.push_back(value); }
  Distribution distribution() const { return distribution_of(values_); }
  /// Mean of the largest `percent` % of the values, at least one; 0 if there are none.
  double mean_of_largest(double percent) const;

 private:
  std::vector<double> values_;
};

/// Values >= 0 counted in buckets of 1/1024 relative width between 2^-40 and 2^40, for replays of days:
/// percentiles are within 0.05 %, count, mean and max exact. 640 KiB, allocated once.
class HistogramValues {
 public:
  HistogramValues();
  void add(double value);
  Distribution distribution() const;
  double mean_of_largest(double percent) const;

 private:
  double value_of(std::size_t bucket) const;
  double rank_value(double percent) const;

  std::vector<std::int64_t> buckets_;
  std::int64_t count_ = 0;
  double sum_ = 0, max_ = 0;
};

/// The figures as records come, in the order of vsyncs, and as eye frames are done, in the order of time.
template <typename Values>
class BasicPacing {
 public:
  void add(const FrameRecord& record);
  void add_frame_done(std::int64_t done_ns);
  PacingFigures figures() const;
  FrameRate rate() const;

 private:
  void add_new_frame(const FrameRecord& record);
  void add_error(const FrameRecord& record);

  PacingFigures counts_;
  Values mtp_rotation_ms_, mtp_translation_ms_, frame_age_ms_, angular_error_deg_, position_error_mm_;
  Values animation_error_ms_, frame_time_ms_;
  std::int64_t last_frame_ = -1, last_sim_ns_ = -1, last_disp_ns_ = -1;
  std::array<std::array<double, 2>, 2> last_errors_deg_{};  // of the two vsyncs before, oldest first
  int last_errors_count_ = 0;
  double judder_sum_ = 0;
  std::int64_t judder_count_ = 0;
  std::int64_t frames_done_ = 0, first_done_ns_ = 0, last_done_ns_ = 0;
};

extern template class BasicPacing<ExactValues>;
extern template class BasicPacing<HistogramValues>;
using PacingAccumulator = BasicPacing<HistogramValues>;

}  // namespace brace
