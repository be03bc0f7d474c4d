#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/metrics/frame_record.hpp"
#include "runtime/report/output_file.hpp"
#include "runtime/timeline/job_record.hpp"

namespace brace {

// frames.csv: a row per vsync, comma separated, "\n" line ends, a header line. Times are integer nanoseconds,
// flags 0 or 1, real numbers the shortest decimal that reads back as the same double ("inf" and "-inf" where
// infinite). A cell is empty where there is no value: -1 in a time or frame index of FrameRecord, NaN in a
// real number. Equal records give equal bytes.

/// Writes rows as they come, in constant memory.
class FrameCsvWriter {
 public:
  explicit FrameCsvWriter(const std::filesystem::path& path);
  void append(const FrameRecord& record);
  /// Flushes and closes; errors throw. Without it the file may be incomplete.
  void close();

 private:
  OutputFile file_;
  std::string row_;
};

/// The same for costs.csv; runtime/timeline/costs_csv.hpp has its format and its reader.
class CostCsvWriter {
 public:
  explicit CostCsvWriter(const std::filesystem::path& path);
  void append(const JobRecord& record);
  void close();

 private:
  OutputFile file_;
  std::string row_;
};

/// Columns are found by the names in the header: their order does not matter and unknown ones are ignored.
/// Throws brace::Error (exit code 2) naming file, line and column.
std::vector<FrameRecord> read_frames_csv(const std::filesystem::path& path);

}  // namespace brace
