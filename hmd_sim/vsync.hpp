#pragma once

#include <cstdint>
#include <string_view>

#include "base/time.hpp"

namespace brace::sim {

/// A rate in hertz as a fraction, so that 59.94 Hz = 60000/1001 has no rounding.
struct Rate {
  std::int64_t num = 90, den = 1;
  double hz() const { return static_cast<double>(num) / static_cast<double>(den); }
  double period_s() const { return static_cast<double>(den) / static_cast<double>(num); }
};

/// Vsync k = epoch + floor(k * 10^9 * den / num) ns, exact for every k whose time fits 64 bits (292 years):
/// no drift, no accumulated rounding.
class VsyncClock {
 public:
  /// Throws input_error unless 0 < num, den and num * den <= 9 * 10^9.
  VsyncClock(SimTime epoch, Rate rate);

  SimTime epoch() const { return epoch_; }
  Rate rate() const { return rate_; }
  SimTime time_of(std::int64_t index) const;
  /// time_of(index + 1) - time_of(index): differs by at most 1 ns between vsyncs.
  SimDuration period_after(std::int64_t index) const { return time_of(index + 1) - time_of(index); }
  /// Smallest index whose time is >= `time`.
  std::int64_t first_at_or_after(SimTime time) const;
  /// Largest index whose time is <= `time`.
  std::int64_t last_at_or_before(SimTime time) const;

 private:
  SimTime epoch_;
  Rate rate_;
  std::int64_t cycle_ns_;  // 10^9 * den: `num` vsyncs take exactly this long
};

enum class ScanDirection { global, top_to_bottom, bottom_to_top, left_to_right, right_to_left };
std::string_view to_string(ScanDirection direction);

struct ScanOut {
  ScanDirection direction = ScanDirection::top_to_bottom;
  double fraction = 1.0;  // of the refresh period that the lines take
};

/// How pixels turn into light.
struct Emission {
  SimDuration delay{0};        // from a line's scan-out to its first light
  SimDuration persistence{0};  // how long a line stays lit in a period
};

/// From the vsync to the moment a line is scanned out: (line / lines) * T_scan with T_scan = fraction *
/// period; T_scan for every line of a global panel, which is loaded first and then lit. `line` counts in scan
/// direction's axis from the top or left; 0 <= line < lines.
SimDuration scan_out_offset(const ScanOut& scan, Rate rate, int line, int lines);

/// Photon times of one vsync. A line's photon time is the middle of its lit time: vsync + scan-out offset +
/// emission delay + persistence / 2 (numerics: d_f + (row/rows) T_scan + t_emit). first, mid and last are the
/// first, the middle (half of T_scan) and the last line in scan order; equal for a global panel.
struct PhotonTimes {
  SimTime first_row, mid, last_row;
};

/// Where a point of the panel is on the way from the first line of the scan-out (0) to the last (1), linear
/// in the panel's uv (u right, v down). 0 everywhere for a global panel, whose lines are lit together.
struct ScanFraction {
  double per_u = 0.0, per_v = 0.0, base = 0.0;
  double at(double u, double v) const { return per_u * u + per_v * v + base; }
};
ScanFraction scan_fraction(ScanDirection direction, int lines);

PhotonTimes photon_times(SimTime vsync, const ScanOut& scan, Rate rate, const Emission& emission, int lines);

}  // namespace brace::sim
