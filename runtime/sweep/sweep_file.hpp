#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "runtime/session/session.hpp"

namespace brace {

/// What a point sets a key to: a number or text for tables and CSV (flags and lists as their TOML text).
using SweepValue = std::variant<std::int64_t, double, std::string>;

/// "0.5", "quad"; the shortest decimal that reads back as the same double.
std::string to_text(const SweepValue& value);

struct SweepSetting {
  std::string key;        // of the session: "pipeline.warp", "stage.dvr.step"
  std::string toml_text;  // what the session reads
  SweepValue value;       // what tables show

  bool operator==(const SweepSetting&) const = default;
};

/// One session of a sweep, as what differs from the session that it starts from.
struct SweepPoint {
  std::string place;                   // "sweep.toml: point 3", for messages
  std::vector<SweepSetting> settings;  // [set] first, then the point's own; a later one wins
};

/// A sweep file: a session, what all points set, and points from a grid, a list, or every grid point with
/// every entry of the list.
struct SweepFile {
  std::filesystem::path file;
  std::filesystem::path session;  // absolute
  std::int64_t repeat = 1;        // runs per point; run k of a point has the session's seed + k - 1
  std::vector<std::string> keys;  // that differ between points, in the file's order
  std::string knob;               // of them, the one that moves along a method's curve; "": not said
  std::vector<SweepPoint> points;
};

inline constexpr std::size_t sweep_points_max = 100'000;

/// Reads a sweep file. In [grid] a key has the list of its values; the first key varies slowest. Throws
/// input_error naming file and line. Whether a session takes the keys is not looked at here.
SweepFile read_sweep(const std::filesystem::path& file);
SweepFile parse_sweep(const std::string& text, const std::filesystem::path& file);

}  // namespace brace
