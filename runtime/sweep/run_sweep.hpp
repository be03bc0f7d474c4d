#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "runtime/host/stage_registry.hpp"
#include "runtime/sweep/results.hpp"
#include "runtime/sweep/sweep_file.hpp"

namespace brace {

struct SweepOptions {
  std::filesystem::path program;       // `brace`: every run is a process of its own
  std::vector<std::string> arguments;  // for every run besides: --gpu, --plugin-path
  std::string version;                 // of Brace
  std::filesystem::path page_folder;   // the page's template; empty: no page
  int jobs = 1;                        // runs at a time; those that measure run alone
  bool retry_failed = false;           // run what has failed or crashed again
  bool keep_runs = false;              // keep the run directories under runs/
  std::function<bool()> interrupted;   // asked often; true: running ones are ended, the rest stays pending
  std::function<void(const SweepRun&, const SweepOutcome&, const SweepCounts&)>
      told;  // after each run; may be empty
};

/// Reads and checks the session of every point. Throws input_error naming sweep file and point.
std::vector<PlannedPoint> plan_sweep(const SweepFile& sweep, const StageRegistry& stages);

/// Runs what is pending and writes `folder`: results.sqlite, results.csv
/// and report.html. Goes on where an earlier call
/// was stopped, by whatever; only one at a time per folder. A run that fails or crashes is recorded as such.
/// Throws brace::Error when the folder cannot be used or written, and then what is recorded stays.
SweepCounts run_sweep(const SweepFile& sweep, const std::vector<PlannedPoint>& points,
                      const SweepOptions& options, const std::filesystem::path& folder);

}  // namespace brace
