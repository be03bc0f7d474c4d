#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/metrics/frame_record.hpp"
#include "runtime/metrics/pacing.hpp"
#include "runtime/timeline/job_record.hpp"

namespace brace {

/// What a stage family was filled with: {"warp", "warp/quad"}.
struct StageChoice {
  std::string family;
  std::string stage;
};

/// A stage the run did without, and why.
struct LeftOut {
  std::string stage;
  std::string reason;
};

/// A name and a value, for what a run wants said about itself beyond the fixed keys ("trace repairs",
/// "none").
struct Fact {
  std::string name;
  std::string value;
};

/// A table for the page (prediction error per horizon, for instance). Every row has columns.size() cells.
struct ReportTable {
  std::string title;
  std::string note;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

/// What the panel showed at a vsync: PNG files, absolute or relative to the run directory.
struct EyePicture {
  std::int64_t vsync_index = 0;
  std::filesystem::path left_png;
  std::filesystem::path right_png;
};

/// A rule that a stage broke.
struct WatchdogFault {
  std::string stage;             // "cast/mip"
  std::string clause;            // "NaN or Inf in a result"
  std::uint64_t count = 0;       // of rays, words of memory or jobs
  std::int64_t first_frame = 0;  // the first eye frame it was seen in; of warps the first vsync
};

/// Records of one pipeline. A run has at least one series; a comparison (thesis Fig. 18: none and quad) has
/// several with different labels. Records and jobs are not owned and must outlive the report.
struct RunSeries {
  std::string label;  // "" is fine for a single series
  std::vector<StageChoice> pipeline;
  std::vector<LeftOut> left_out;
  std::span<const FrameRecord> records;  // in the order of vsyncs
  std::span<const JobRecord> jobs;       // in the order of submission
  std::vector<EyePicture> pictures;
  std::vector<WatchdogFault> faults;
  /// Figures of the whole run, for replays too long to keep all records: `records` and `jobs` are then the
  /// part that was kept, for the page. Without them the figures are those of `records` and `jobs`.
  std::optional<PacingFigures> figures;
  std::optional<FrameRate> rate;
  std::optional<double> stereo_layer_mib;  // memory of a single-pass stage's layers
};

struct ClockInfo {
  std::string mode;             // virtual or wall
  std::string queue;            // single, priority or dual
  std::string cost;             // model:NAME, measured, recorded:DIR, scripted
  std::string cost_resolution;  // full or as_rendered
};

/// Figures of the machine the run was made on: the only ones that may differ between equal runs.
struct HostFigures {
  double wall_s = 0;
  double cpu_s = 0;
  std::uint64_t peak_rss_bytes = 0;
  std::vector<Fact> facts;  // GPU, driver, threads, …
};

/// Everything the writers of a run directory need. Plain data.
struct ReportInput {
  std::string version;  // of Brace
  std::string device;   // profile name
  double refresh_hz = 0;
  double resolution_scale = 1;
  std::string trace;
  ClockInfo clock;
  bool deterministic = false;
  std::string failure;   // "" or what ended the run before its end: it is incomplete
  std::string watchdog;  // its level; "" if it was off
  std::vector<RunSeries> series;
  std::vector<Fact> facts;
  std::vector<ReportTable> tables;
  std::string session_toml;  // the resolved session
  HostFigures host;
};

}  // namespace brace
