#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "base/time.hpp"
#include "runtime/metrics/frame_record.hpp"
#include "runtime/metrics/pacing.hpp"

namespace brace {

/// What one picture in the window took, and how old it was. Host time, ms, but for the first four: device
/// time.
struct LiveCosts {
  double opening = 0.0, cast = 0.0, closing = 0.0;  // not told apart where native stages cast: all is `cast`
  double warp = 0.0;                                // and lens
  double view = 0.0;                                // what a view other than the picture takes beside it
  double read = 0.0, paint = 0.0,
         present = 0.0;  // from the device; eyes and overlay into the window; showing
};

struct LiveFrame {
  SimTime shown{};                                         // handed to the window system
  double interval_ms = 0.0;                                // since the one before; 0 for the first
  std::int64_t missed = 0;                                 // vsyncs before it without a new picture
  double mtp_rotation_ms = 0.0, mtp_translation_ms = 0.0;  // from the pose shown to `shown`
  double frame_age_ms = 0.0;                               // from the pose cast to `shown`
  LiveCosts costs;
  WorkCounts work;
};

/// Times counted in bins of 0.01 ms up to 2 s: a run of any length takes the same memory.
class MillisecondCounts {
 public:
  static constexpr double bin_ms = 0.01;
  static constexpr int bins = 200'000;

  MillisecondCounts() : counts_(bins + 1) {}
  void add(double ms);
  /// Percentiles are their bin's middle; longer ones than 2 s count as 2 s there. Mean and maximum are exact.
  Distribution distribution() const;

 private:
  std::vector<std::uint32_t> counts_;
  std::int64_t count_ = 0;
  double sum_ms_ = 0.0, max_ms_ = 0.0;
};

/// The pictures of the last seconds, and figures over all of them.
class FrameHistory {
 public:
  static constexpr double kept_s = 4.0;

  void add(const LiveFrame& frame);
  const std::deque<LiveFrame>& recent() const { return recent_; }
  bool empty() const { return recent_.empty(); }

  /// Pictures per second over the last one.
  double rate_hz() const;
  /// Of a figure over the pictures kept.
  template <class Figure>
  Distribution over_recent(const Figure& figure) const {
    std::vector<double> values;
    values.reserve(recent_.size());
    for (const LiveFrame& frame : recent_)
      values.push_back(figure(frame));
    return distribution_of(std::move(values));
  }

  /// Over the whole run but its first second, in which caches are still being filled. Percentiles to 0.01 ms.
  struct Totals {
    std::int64_t pictures = 0, missed = 0;
    Distribution interval_ms, cast_ms;
    double missed_ratio() const {
      return missed > 0 ? static_cast<double>(missed) / static_cast<double>(pictures + missed) : 0.0;
    }
  };
  Totals totals() const;
  std::int64_t pictures() const { return pictures_; }  // the first second's, too

 private:
  std::deque<LiveFrame> recent_;
  MillisecondCounts intervals_, casts_;
  std::int64_t pictures_ = 0, missed_ = 0;
  SimTime first_shown_{};
};

}  // namespace brace
