#include "hmd_sim/vsync.hpp"

#include <cmath>

#include "base/error.hpp"

namespace brace::sim {
namespace {

constexpr std::int64_t ns_per_second = 1'000'000'000;

struct Division {
  std::int64_t quotient, remainder;  // 0 <= remainder < divisor
};

// Rounds towards minus infinity; divisor > 0.
constexpr Division floor_divide(std::int64_t value, std::int64_t divisor) {
  Division d{value / divisor, value % divisor};
  if (d.remainder < 0) {
    d.remainder += divisor;
    --d.quotient;
  }
  return d;
}

SimDuration rounded_ns(double ns) {
  return SimDuration(std::llround(ns));
}

double scan_time_ns(const ScanOut& scan, Rate rate) {
  return scan.fraction * rate.period_s() * 1e9;
}

}  // namespace

VsyncClock::VsyncClock(SimTime epoch, Rate rate) : epoch_(epoch), rate_(rate), cycle_ns_(0) {
  // The limit keeps every product below 2^63: remainders are < num and < 10^9 den.
  constexpr std::int64_t limit = 9 * ns_per_second;
  if (rate.num <= 0 || rate.den <= 0 || rate.num > limit / rate.den) {
    throw input_error("rate {}/{} Hz: numerator and denominator must be positive, their product at most {}",
                      rate.num, rate.den, limit);
  }
  cycle_ns_ = ns_per_second * rate.den;
}

SimTime VsyncClock::time_of(std::int64_t index) const {
  const Division cycles = floor_divide(index, rate_.num);
  const std::int64_t part_ns = cycles.remainder * cycle_ns_ / rate_.num;
  std::int64_t whole_ns = 0;
  std::int64_t time_ns = 0;
  if (__builtin_mul_overflow(cycles.quotient, cycle_ns_, &whole_ns) ||
      __builtin_add_overflow(whole_ns, part_ns, &time_ns) ||
      __builtin_add_overflow(time_ns, to_ns(epoch_), &time_ns)) {
    throw input_error("vsync {} at {}/{} Hz lies beyond the 292 years that 64-bit nanoseconds hold", index,
                      rate_.num, rate_.den);
  }
  return sim_time(time_ns);
}

std::int64_t VsyncClock::first_at_or_after(SimTime time) const {
  // floor(k c / n) >= t is k c / n >= t for whole t, so k = ceil(t n / c).
  const Division cycles = floor_divide(to_ns(time) - to_ns(epoch_), cycle_ns_);
  const std::int64_t part = (cycles.remainder * rate_.num + cycle_ns_ - 1) / cycle_ns_;
  return cycles.quotient * rate_.num + part;
}

std::int64_t VsyncClock::last_at_or_before(SimTime time) const {
  const std::int64_t next = first_at_or_after(time);
  return time_of(next) == time ? next : next - 1;
}

std::string_view to_string(ScanDirection direction) {
  switch (direction) {
    case ScanDirection::global:
      return "global";
    case ScanDirection::top_to_bottom:
      return "top_to_bottom";
    case ScanDirection::bottom_to_top:
      return "bottom_to_top";
    case ScanDirection::left_to_right:
      return "left_to_right";
    case ScanDirection::right_to_left:
      return "right_to_left";
  }
  return "unknown";
}

SimDuration scan_out_offset(const ScanOut& scan, Rate rate, int line, int lines) {
  BRACE_CHECK(lines > 0 && line >= 0 && line < lines);
  if (scan.direction == ScanDirection::global) return rounded_ns(scan_time_ns(scan, rate));
  const bool reversed =
      scan.direction == ScanDirection::bottom_to_top || scan.direction == ScanDirection::right_to_left;
  const int order = reversed ? lines - 1 - line : line;
  return rounded_ns(scan_time_ns(scan, rate) * order / lines);
}

ScanFraction scan_fraction(ScanDirection direction, int lines) {
  BRACE_CHECK(lines > 0);
  if (direction == ScanDirection::global || lines == 1) return {};
  // Line i has its middle at (i + 0.5) / lines and comes i / (lines - 1) of the way.
  const double slope = static_cast<double>(lines) / (lines - 1), base = -0.5 / (lines - 1);
  switch (direction) {
    case ScanDirection::top_to_bottom:
      return {0.0, slope, base};
    case ScanDirection::bottom_to_top:
      return {0.0, -slope, 1.0 - base};
    case ScanDirection::left_to_right:
      return {slope, 0.0, base};
    default:
      return {-slope, 0.0, 1.0 - base};
  }
}

PhotonTimes photon_times(SimTime vsync, const ScanOut& scan, Rate rate, const Emission& emission, int lines) {
  BRACE_CHECK(lines > 0);
  const SimTime lit = vsync + emission.delay + emission.persistence / 2;
  const double scan_ns = scan_time_ns(scan, rate);
  if (scan.direction == ScanDirection::global) {
    const SimTime all = lit + rounded_ns(scan_ns);
    return {all, all, all};
  }
  return {lit, lit + rounded_ns(0.5 * scan_ns), lit + rounded_ns(scan_ns * (lines - 1) / lines)};
}

}  // namespace brace::sim
