#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "runtime/metrics/frame_record.hpp"

namespace brace {

/// cast: ray casting of an eye frame. warp: a display image (re-projection and distortion). update: work on
/// the volume's structures (distance maps after a transfer-function edit). The names are those of costs.csv
/// and of brace_cost_functions.
enum class JobKind : std::uint8_t { cast, warp, update };
inline constexpr int job_kind_count = 3;

constexpr const char* name_of(JobKind kind) {
  return kind == JobKind::cast ? "cast" : kind == JobKind::warp ? "warp" : "update";
}

constexpr std::optional<JobKind> job_kind_from(std::string_view name) {
  if (name == "cast") return JobKind::cast;
  if (name == "warp") return JobKind::warp;
  if (name == "update") return JobKind::update;
  return std::nullopt;
}

/// What the simulated GPU did with one job: a row of costs.csv. For a finished job
/// end_ns - start_ns = cost_ns + preempted_ns.
struct JobRecord {
  std::int64_t job = 0;  // in order of submission, from 0
  JobKind kind = JobKind::cast;
  std::int64_t index = 0;  // cast, update: eye frame; warp: vsync it is for
  std::int64_t submit_ns = 0;
  std::int64_t start_ns = -1;     // first work on it; -1 if the run ended before
  std::int64_t end_ns = -1;       // -1 if the run ended before
  std::int64_t preempted_ns = 0;  // between start and end, but not working on this job
  std::int64_t cost_ns = 0;       // from the cost source
  WorkCounts work{};
  bool ends_frame = true;  // false: a part of a chunked cast, and not its last; not in costs.csv

  bool operator==(const JobRecord&) const = default;
};

}  // namespace brace
