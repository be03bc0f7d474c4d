#include "tools/live/scale_choice.hpp"

#include <algorithm>
#include <cmath>

namespace brace {

namespace {

constexpr double probe_scale = 0.1;
constexpr double scale_min = 0.03;
constexpr int steps_max = 5;
constexpr double share_used = 0.7;  // of a period: the overlay, and pictures that take longer than others
constexpr double share_held = 0.9;

}  // namespace

LiveScale choose_scale(double asked, double rate_hz, double window_ms,
                       const std::function<double(double scale)>& eyes_ms_at) {
  const double period_ms = 1e3 / rate_hz, budget_ms = period_ms * share_used - window_ms;
  const double probed = std::min(probe_scale, asked), smallest = std::min(scale_min, asked);
  LiveScale found{.scale = probed, .eyes_ms = eyes_ms_at(probed), .window_ms = window_ms};
  for (int step = 0; step < steps_max && found.eyes_ms > budget_ms && found.scale > smallest; ++step) {
    const double ratio = std::sqrt(std::max(budget_ms, 0.0) / found.eyes_ms);
    found.scale = std::max(found.scale * std::min(ratio, 0.8), smallest);
    found.eyes_ms = eyes_ms_at(found.scale);
  }
  // Upwards, time grows no faster than the pixels do.
  if (found.eyes_ms < budget_ms && found.scale == probed && probed < asked) {
    found.scale = std::min(probed * std::sqrt(budget_ms / found.eyes_ms), asked);
    found.eyes_ms = eyes_ms_at(found.scale);
  }
  found.holds = found.eyes_ms + window_ms < share_held * period_ms;
  return found;
}

}  // namespace brace
