#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "hmd_sim/pose_trace.hpp"

namespace brace::sim {

enum class TraceFormat {
  // The first three take gaze, too: brace and tum as three more numbers per line (gaze_x gaze_y gaze_z, unit
  // vector in the head frame), euroc as columns that the header names gaze_x, gaze_y, gaze_z or gaze_yaw,
  // gaze_pitch (radians, to the left and up). NaN (in CSV an empty cell, too) is a reading that is lost.
  brace,  // "# brace pose trace 1": int64 ns, x y z qx qy qz qw with 17 digits; round-trips exactly
  tum,    // timestamp_s tx ty tz qx qy qz qw
  euroc,  // CSV with a '#' header: timestamp_ns, px, py, pz, qw, qx, qy, qz, …
  aframe  // A-Frame motion-capture JSON: degrees (YXZ Euler), metres, milliseconds; key `camera`
};
std::string to_string(TraceFormat format);
/// Throws input_error listing the names.
TraceFormat parse_trace_format(const std::string& name);

/// Everything that was repaired while reading; nothing is mended silently.
struct TraceRepairs {
  std::size_t poses_read = 0;
  std::size_t poses_kept = 0;
  std::size_t dropped_non_finite = 0;      // NaN or infinity in time or pose
  std::size_t dropped_bad_quaternion = 0;  // | |q| - 1 | > 1e-2
  std::size_t dropped_time = 0;            // time not later than the last one kept
  std::size_t renormalised = 0;            // 1e-9 < | |q| - 1 | <= 1e-2
  std::size_t sign_flips = 0;              // q replaced by -q (the same rotation) for continuity
  std::size_t gaps = 0;                    // intervals > 50 ms, marked invalid
  std::string first_problem;               // "file:line: what", the first pose dropped or gaze lost for it
  std::size_t gaze_read = 0;               // readings, of poses kept
  std::size_t gaze_lost = 0;               // of these NaN: blinks; the last valid one holds
  std::size_t gaze_bad = 0;                // of these neither: | |g| - 1 | > 1e-2, or z >= 0; taken as lost

  std::size_t dropped() const { return dropped_non_finite + dropped_bad_quaternion + dropped_time; }
  bool operator==(const TraceRepairs&) const = default;
};

/// One line in words: "2568 poses, nothing repaired" or what was.
std::string describe(const TraceRepairs& repairs);

struct TraceReadOptions {
  bool strict = false;  // a pose that would have to be dropped is an error naming file and line instead
};

struct TraceReadResult {
  PoseTrace trace;  // its name is the file's stem; times as recorded
  TraceRepairs repairs;
  TraceFormat format;
};

/// Reads a trace; the format is found from the content. Throws input_error naming file and line: unreadable
/// file, unknown format (accepted ones are listed), a line that is not numbers, fewer than two valid poses.
TraceReadResult read_trace(const std::filesystem::path& path, const TraceReadOptions& options = {});
/// The same from text; `name` stands for the file in messages.
TraceReadResult parse_trace(const std::string& text, const std::string& name,
                            const TraceReadOptions& options = {});

/// `notes` become '#' lines of the header (brace and tum; euroc has one fixed header line). aframe cannot be
/// written. Throws input_error naming the file when it cannot be written; a half-written file is removed.
void write_trace(const std::filesystem::path& path, const PoseTrace& trace, TraceFormat format,
                 const std::vector<std::string>& notes = {});
void write_trace(std::ostream& out, const PoseTrace& trace, TraceFormat format,
                 const std::vector<std::string>& notes = {});

}  // namespace brace::sim
