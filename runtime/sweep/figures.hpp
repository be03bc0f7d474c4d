#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace brace {

/// Columns of a sweep's results: figures of a run that its records alone determine. Times of jobs are those
/// of the simulated GPU (of the device with clock.cost = "measured"); counts are means per job.
const std::vector<std::string>& sweep_figure_names();

/// The figures of a run directory in the order of the names; none where the run has no such figure. Throws
/// brace::Error if it is no run directory.
std::vector<std::optional<double>> read_sweep_figures(const std::filesystem::path& run);

/// What the host spent on a run: differs between equal runs.
struct SweepHostFigures {
  double wall_s = 0, cpu_s = 0;
  double peak_rss_bytes = 0;
};
SweepHostFigures read_sweep_host_figures(const std::filesystem::path& run);

}  // namespace brace
