#pragma once

#include <filesystem>

#include "runtime/sweep/results.hpp"

namespace brace {

/// report.html of a sweep: work-precision curves, their Pareto front, what each method needs for a DSSIM of
/// `sweep_page_error`, the best that holds 90 Hz, and all points in a table. A method is what the varied keys
/// but the knob are set to. Repetitions are one point: the median of those that are done. `page_folder`
/// holds the template. Throws brace::Error when a file cannot be read or written.
inline constexpr double sweep_page_error = 0.01;
void write_sweep_page(const std::filesystem::path& file, const SweepFile& sweep,
                      const std::vector<SweepRow>& rows, const std::string& version,
                      const std::filesystem::path& page_folder);

/// The key that moves along a method's curve: the sweep's own `knob`; else the last one whose values are all
/// numbers; "" if there is none.
std::string knob_of(const SweepFile& sweep);

}  // namespace brace
