#include "runtime/metrics/pacing.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr double ms_per_ns = 1e-6;
constexpr double deg_per_rad = 180.0 / std::numbers::pi;

/// 1-based nearest rank.
std::int64_t rank_of(std::int64_t count, double percent) {
  const auto rank = static_cast<std::int64_t>(std::ceil(percent * static_cast<double>(count) / 100.0 - 1e-9));
  return std::clamp<std::int64_t>(rank, 1, count);
}

/// How many values "the largest percent %" are.
std::int64_t largest_count(std::int64_t count, double percent) {
  const auto wanted =
      static_cast<std::int64_t>(std::floor(percent * static_cast<double>(count) / 100.0 + 1e-9));
  return std::clamp<std::int64_t>(wanted, 1, count);
}

// Buckets of a histogram: a double's exponent and the 10 highest bits of its fraction.
constexpr int fraction_bits = 10;
constexpr int exponent_min = -40, exponent_max = 40;
constexpr std::size_t bucket_count = static_cast<std::size_t>(exponent_max - exponent_min) << fraction_bits;
constexpr std::uint64_t first_bucket_bits = static_cast<std::uint64_t>(1023 + exponent_min) << fraction_bits;

std::size_t bucket_of(double value) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(value) >> (52 - fraction_bits);
  if (bits < first_bucket_bits) return 0;
  return std::min<std::size_t>(bits - first_bucket_bits, bucket_count - 1);
}

double bucket_begin(std::size_t bucket) {
  return std::bit_cast<double>((first_bucket_bits + bucket) << (52 - fraction_bits));
}

}  // namespace

double nearest_rank(std::span<const double> ascending, double percent) {
  BRACE_CHECK(!ascending.empty() && percent > 0 && percent <= 100);
  return ascending[static_cast<std::size_t>(rank_of(static_cast<std::int64_t>(ascending.size()), percent) -
                                            1)];
}

Distribution distribution_of(std::vector<double> values) {
  Distribution d;
  if (values.empty()) return d;
  d.count = static_cast<std::int64_t>(values.size());
  for (const double value : values)
    d.mean += value;  // in the order given, before sorting
  d.mean /= static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  d.p50 = nearest_rank(values, 50);
  d.p95 = nearest_rank(values, 95);
  d.p99 = nearest_rank(values, 99);
  d.max = values.back();
  return d;
}

double ExactValues::mean_of_largest(double percent) const {
  if (values_.empty()) return 0;
  std::vector<double> descending = values_;
  std::sort(descending.begin(), descending.end(), std::greater<>());
  const std::int64_t count = largest_count(static_cast<std::int64_t>(descending.size()), percent);
  double sum = 0;
  for (std::int64_t i = 0; i < count; ++i)
    sum += descending[static_cast<std::size_t>(i)];
  return sum / static_cast<double>(count);
}

HistogramValues::HistogramValues() : buckets_(bucket_count, 0) {}

void HistogramValues::add(double value) {
  ++buckets_[bucket_of(std::max(value, 0.0))];
  ++count_;
  sum_ += value;
  max_ = std::max(max_, value);
}

/// Middle of a bucket; the lowest one also holds everything below its range.
double HistogramValues::value_of(std::size_t bucket) const {
  if (bucket == 0) return 0;
  return std::min(max_, 0.5 * (bucket_begin(bucket) + bucket_begin(bucket + 1)));
}

double HistogramValues::rank_value(double percent) const {
  std::int64_t left = rank_of(count_, percent);
  std::size_t bucket = 0;
  for (; bucket < bucket_count; ++bucket) {
    left -= buckets_[bucket];
    if (left <= 0) break;
  }
  return value_of(bucket);
}

Distribution HistogramValues::distribution() const {
  if (count_ == 0) return {};
  return {.count = count_,
          .mean = sum_ / static_cast<double>(count_),
          .p50 = rank_value(50),
          .p95 = rank_value(95),
          .p99 = rank_value(99),
          .max = max_};
}

double HistogramValues::mean_of_largest(double percent) const {
  if (count_ == 0) return 0;
  const std::int64_t count = largest_count(count_, percent);
  std::int64_t left = count;
  double sum = 0;
  for (std::size_t bucket = bucket_count; bucket-- > 0 && left > 0;) {
    const std::int64_t taken = std::min(left, buckets_[bucket]);
    sum += static_cast<double>(taken) * value_of(bucket);
    left -= taken;
  }
  return sum / static_cast<double>(count);
}

template <typename Values>
void BasicPacing<Values>::add(const FrameRecord& record) {
  ++counts_.vsyncs;
  if (record.displayed_frame < 0) {
    ++counts_.startup_vsyncs;
    return;
  }
  if (record.missed) {
    ++counts_.missed_vsyncs;
    if (record.stale_run == 1) ++counts_.stale_runs;
    counts_.longest_stale_run = std::max<std::int64_t>(counts_.longest_stale_run, record.stale_run);
  }
  if (record.displayed_frame != last_frame_) add_new_frame(record);
  if (!record.pose_valid) {
    ++counts_.gap_vsyncs;
    last_errors_count_ = 0;
    return;
  }
  mtp_rotation_ms_.add(static_cast<double>(record.mtp_rotation_ns) * ms_per_ns);
  mtp_translation_ms_.add(static_cast<double>(record.mtp_translation_ns) * ms_per_ns);
  frame_age_ms_.add(static_cast<double>(record.frame_age_ns) * ms_per_ns);
  add_error(record);
}

template <typename Values>
void BasicPacing<Values>::add_new_frame(const FrameRecord& record) {
  ++counts_.frames_shown;
  if (record.render_target_ns >= 0 && last_sim_ns_ >= 0) {
    const std::int64_t sim_ns = record.render_target_ns - last_sim_ns_;
    const std::int64_t disp_ns = record.photon_mid_ns - last_disp_ns_;
    animation_error_ms_.add(static_cast<double>(std::abs(sim_ns - disp_ns)) * ms_per_ns);
  }
  last_frame_ = record.displayed_frame;
  last_sim_ns_ = record.render_target_ns;
  last_disp_ns_ = record.photon_mid_ns;
}

template <typename Values>
void BasicPacing<Values>::add_error(const FrameRecord& record) {
  if (!std::isfinite(record.angular_error_rad) || !std::isfinite(record.position_error_m)) {
    last_errors_count_ = 0;
    return;
  }
  angular_error_deg_.add(record.angular_error_rad * deg_per_rad);
  position_error_mm_.add(record.position_error_m * 1e3);
  const std::array<double, 2> error_deg{record.angular_error_vector_rad[0] * deg_per_rad,
                                        record.angular_error_vector_rad[1] * deg_per_rad};
  if (!std::isfinite(error_deg[0]) || !std::isfinite(error_deg[1])) {
    last_errors_count_ = 0;
    return;
  }
  if (last_errors_count_ == 2) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double second = error_deg[axis] - 2 * last_errors_deg_[1][axis] + last_errors_deg_[0][axis];
      judder_sum_ += second * second;
    }
    ++judder_count_;
  }
  last_errors_deg_ = {last_errors_deg_[1], error_deg};
  last_errors_count_ = std::min(last_errors_count_ + 1, 2);
}

template <typename Values>
void BasicPacing<Values>::add_frame_done(std::int64_t done_ns) {
  if (frames_done_ == 0) {
    first_done_ns_ = done_ns;
  } else {
    frame_time_ms_.add(static_cast<double>(done_ns - last_done_ns_) * ms_per_ns);
  }
  last_done_ns_ = done_ns;
  ++frames_done_;
}

template <typename Values>
PacingFigures BasicPacing<Values>::figures() const {
  PacingFigures figures = counts_;
  const std::int64_t after_startup = figures.vsyncs - figures.startup_vsyncs;
  if (after_startup > 0) {
    figures.missed_ratio = static_cast<double>(figures.missed_vsyncs) / static_cast<double>(after_startup);
  }
  figures.mtp_rotation_ms = mtp_rotation_ms_.distribution();
  figures.mtp_translation_ms = mtp_translation_ms_.distribution();
  figures.frame_age_ms = frame_age_ms_.distribution();
  figures.angular_error_deg = angular_error_deg_.distribution();
  figures.position_error_mm = position_error_mm_.distribution();
  figures.animation_error_ms = animation_error_ms_.distribution();
  if (judder_count_ > 0) figures.judder_rms_deg = std::sqrt(judder_sum_ / static_cast<double>(judder_count_));
  return figures;
}

template <typename Values>
FrameRate BasicPacing<Values>::rate() const {
  FrameRate rate{.frames = frames_done_};
  if (frames_done_ < 2 || last_done_ns_ == first_done_ns_) return rate;
  rate.fps_avg =
      static_cast<double>(frames_done_ - 1) / (static_cast<double>(last_done_ns_ - first_done_ns_) * 1e-9);
  const double p99_ms = frame_time_ms_.distribution().p99;
  if (p99_ms > 0) rate.fps_1pct_low = 1000.0 / p99_ms;
  rate.fps_1pct_low_mean = 1000.0 / frame_time_ms_.mean_of_largest(1);
  return rate;
}

template class BasicPacing<ExactValues>;
template class BasicPacing<HistogramValues>;

PacingFigures pacing_figures(std::span<const FrameRecord> records) {
  BasicPacing<ExactValues> pacing;
  for (const FrameRecord& record : records)
    pacing.add(record);
  return pacing.figures();
}

FrameRate frame_rate(std::span<const std::int64_t> done_ns) {
  BasicPacing<ExactValues> pacing;
  for (const std::int64_t done : done_ns)
    pacing.add_frame_done(done);
  return pacing.rate();
}

}  // namespace brace
