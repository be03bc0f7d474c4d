#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runtime/sweep/database.hpp"
#include "runtime/sweep/figures.hpp"
#include "runtime/sweep/sweep_file.hpp"

namespace brace {

/// A run of a sweep: repetition `repeat` (from 1) of point `point` (from 1).
struct SweepRun {
  std::int64_t point = 1, repeat = 1;
  std::int64_t seed = 1;

  bool operator==(const SweepRun&) const = default;
};

/// What came of a run. done: `figures` are there. failed: the run said why in `message` and ended with
/// `exit_code`. crashed: it was ended by `signal`.
struct SweepOutcome {
  enum class Status { pending, done, failed, crashed } status = Status::pending;
  int exit_code = 0;
  int signal = 0;
  std::string message;
  std::vector<std::optional<double>> figures;
  SweepHostFigures host;
};
const char* name_of(SweepOutcome::Status status);

/// A run as it is recorded.
struct SweepRow {
  SweepRun run;
  std::string status, message;
  std::vector<std::optional<double>> figures;  // in the order of sweep_figure_names()
};

/// A point with the session that it stands for.
struct PlannedPoint {
  SweepPoint point;
  std::string session_toml;  // resolved
  std::int64_t seed = 1;     // of the first repetition
  bool alone = false;        // its costs are measured: nothing else may run meanwhile
};

struct SweepCounts {
  std::int64_t runs = 0, pending = 0, done = 0, failed = 0, crashed = 0;
};

/// The results of a sweep in one SQLite file: `meta` (format, version, repeat), `points` (point, the resolved
/// session), `results` (a row per run, in the columns of the CSV) and `host` (what runs took here). All but
/// `host` is the same after any number of interruptions if the cost sources are deterministic.
class SweepResults {
 public:
  /// Opens `file`, or creates it with every run pending. Throws input_error if it holds another sweep.
  SweepResults(const std::filesystem::path& file, const SweepFile& sweep,
               const std::vector<PlannedPoint>& points, const std::string& version);

  /// By point and repetition.
  std::vector<SweepRun> pending();
  /// One transaction: a run is recorded whole or still pending.
  void record(const SweepRun& run, const SweepOutcome& outcome);
  /// Failed and crashed runs are pending again.
  void retry_failed();
  SweepCounts counts();
  /// By point and repetition.
  std::vector<SweepRow> rows();

  /// point,repeat,seed,status,exit_code,signal,message, a column per key, a column per figure; a row per run.
  /// Replaces the file in one step.
  void write_csv(const std::filesystem::path& file);

 private:
  void create(const SweepFile& sweep, const std::vector<PlannedPoint>& points, const std::string& version);
  void expect_same(const SweepFile& sweep, const std::vector<PlannedPoint>& points,
                   const std::string& version);

  Database database_;
  std::vector<std::string> keys_;
};

}  // namespace brace
