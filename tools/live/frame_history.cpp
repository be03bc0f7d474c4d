#include "tools/live/frame_history.hpp"

#include <algorithm>
#include <cmath>

namespace brace {

void MillisecondCounts::add(double ms) {
  const auto bin = static_cast<std::size_t>(std::clamp(std::floor(ms / bin_ms), 0.0, double{bins}));
  ++counts_[bin];
  ++count_;
  sum_ms_ += ms;
  max_ms_ = std::max(max_ms_, ms);
}

Distribution MillisecondCounts::distribution() const {
  Distribution found{.count = count_};
  if (count_ == 0) return found;
  found.mean = sum_ms_ / static_cast<double>(count_);
  found.max = max_ms_;
  const auto at_rank = [&](double percent) {
    const auto rank = static_cast<std::int64_t>(std::ceil(percent / 100.0 * static_cast<double>(count_)));
    std::int64_t seen = 0;
    std::size_t bin = 0;
    while (seen + counts_[bin] < rank)
      seen += counts_[bin++];
    return std::min((static_cast<double>(bin) + 0.5) * bin_ms, max_ms_);
  };
  found.p50 = at_rank(50.0);
  found.p95 = at_rank(95.0);
  found.p99 = at_rank(99.0);
  return found;
}

void FrameHistory::add(const LiveFrame& frame) {
  if (pictures_ == 0) first_shown_ = frame.shown;
  ++pictures_;
  if (frame.shown - first_shown_ >= from_s(1.0)) {
    intervals_.add(frame.interval_ms);
    casts_.add(frame.costs.opening + frame.costs.cast + frame.costs.closing);
    missed_ += frame.missed;
  }
  recent_.push_back(frame);
  while (recent_.size() > 1 && frame.shown - recent_.front().shown > from_s(kept_s))
    recent_.pop_front();
}

double FrameHistory::rate_hz() const {
  if (recent_.size() < 2) return 0.0;
  std::size_t first = recent_.size() - 1;
  while (first > 0 && recent_.back().shown - recent_[first].shown < from_s(1.0))
    --first;
  const double seconds = to_s(recent_.back().shown - recent_[first].shown);
  return seconds > 0.0 ? static_cast<double>(recent_.size() - 1 - first) / seconds : 0.0;
}

FrameHistory::Totals FrameHistory::totals() const {
  Totals totals{.interval_ms = intervals_.distribution(), .cast_ms = casts_.distribution()};
  totals.pictures = totals.interval_ms.count;
  totals.missed = missed_;
  return totals;
}

}  // namespace brace
