#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/compare/compare_records.hpp"

namespace brace {

/// Something the two runs were made with that is not the same: {"clock.cost", "model:gtx-1080", "measured"}.
struct Difference {
  std::string name;
  std::string a, b;
};

struct SeriesComparison {
  std::string label;  // "" for runs with a single series
  RecordsComparison records;
};

struct RunsComparison {
  const char* unit = "vsyncs";  // what is compared one by one: those, or a sweep's "points"
  bool deterministic = false;   // both are
  std::vector<Difference> differences;
  std::vector<SeriesComparison> series;
  std::vector<std::string> labels_only_a, labels_only_b;

  /// No figure of any series is worse.
  bool passed() const;
};

/// Compares two run directories; of each, summary.json and the frames*.csv are read, so a baseline needs no
/// more than those. Runs of one series each are compared whatever their labels; else series of the same
/// label. Throws input_error for a folder that is no run directory, and as compare_records() does.
RunsComparison compare_runs(const std::filesystem::path& a, const std::filesystem::path& b,
                            const CompareOptions& options);

/// The comparison as JSON, format "brace-compare-1", for machines. `confidence` and `seed` are in it.
std::string comparison_json(const RunsComparison& comparison, const std::filesystem::path& a,
                            const std::filesystem::path& b, const CompareOptions& options);

}  // namespace brace
