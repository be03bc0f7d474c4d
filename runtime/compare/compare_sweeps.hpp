#pragma once

#include <filesystem>

#include "runtime/compare/compare_runs.hpp"

namespace brace {

/// Whether a folder is that of a sweep.
bool is_sweep(const std::filesystem::path& folder);

/// Compares two sweeps point by point: points with the same values of the keys that vary, and the same
/// repeat, belong together where both are done. Figures: missed_ratio, dssim and samples (means of the
/// points' own), and the p99 of latencies and frame age; each is the mean over the points. Throws input_error
/// where they vary other keys, have no point in common, or a folder is no sweep's.
RunsComparison compare_sweeps(const std::filesystem::path& a, const std::filesystem::path& b,
                              const CompareOptions& options);

}  // namespace brace
