#pragma once

#include <chrono>
#include <cstdint>

namespace brace {

/// Simulated time: int64 nanoseconds. It has no now(): only the timeline moves it, so simulated and host time
/// (std::chrono::steady_clock) cannot be mixed by accident.
struct SimClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<SimClock, duration>;
  static constexpr bool is_steady = true;
};

using SimTime = SimClock::time_point;
using SimDuration = SimClock::duration;

constexpr SimTime sim_time(std::int64_t ns) {
  return SimTime(SimDuration(ns));
}
constexpr std::int64_t to_ns(SimTime t) {
  return t.time_since_epoch().count();
}
constexpr std::int64_t to_ns(SimDuration d) {
  return d.count();
}
constexpr double to_s(SimDuration d) {
  return static_cast<double>(d.count()) * 1e-9;
}
constexpr double to_s(SimTime t) {
  return to_s(t.time_since_epoch());
}

/// Nearest nanosecond; ties away from zero.
constexpr SimDuration from_s(double seconds) {
  return SimDuration(static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5)));
}

}  // namespace brace
