#include "tools/live/vsync_pace.hpp"

#include <algorithm>
#include <cmath>

namespace brace {

VsyncPace::Slot VsyncPace::take(SimTime ready) {
  const std::int64_t first = clock_.first_at_or_after(ready);
  const std::int64_t index = last_ ? std::max(first, *last_ + 1) : first;
  const std::int64_t missed = last_ ? index - *last_ - 1 : 0;
  last_ = index;
  return {clock_.time_of(index), missed};
}

std::int64_t missed_in(SimDuration interval, sim::Rate rate) {
  return std::max<std::int64_t>(std::llround(to_s(interval) * rate.hz()) - 1, 0);
}

sim::Rate rate_of_hz(double hz) {
  return {std::llround(hz * 1e3), 1000};
}

}  // namespace brace
