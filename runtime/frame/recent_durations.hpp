#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "base/time.hpp"

namespace brace {

/// The last 8 durations of something, for expecting the next. Integers only: the same on every machine.
class RecentDurations {
 public:
  void add(SimDuration duration) {
    kept_[next_] = duration;
    next_ = (next_ + 1) % kept_.size();
    count_ = std::min(count_ + 1, kept_.size());
  }

  SimDuration mean_or(SimDuration fallback) const {
    if (count_ == 0) return fallback;
    SimDuration sum{0};
    for (std::size_t i = 0; i < count_; ++i)
      sum += kept_[i];
    return sum / static_cast<std::int64_t>(count_);
  }

  SimDuration max_or(SimDuration fallback) const {
    return count_ == 0
               ? fallback
               : *std::max_element(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(count_));
  }

 private:
  std::array<SimDuration, 8> kept_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace brace
