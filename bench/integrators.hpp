#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"

namespace brace {

struct IntegratorBenchOptions {
  gpu::DeviceOptions device;
  std::filesystem::path data_folder;
  /// Folder with scans to measure on as well; empty: formulas alone. The command takes $BRACE_BENCH_VOLUMES.
  std::filesystem::path volumes;
  bool quick = false;
};

/// One setting of one rule: machine-free work and error against very small steps.
struct WorkPrecision {
  std::string scene, rule;  // "bonsai, band"; "linear-source", "adaptive linear-source"
  bool adaptive = false;
  double setting = 0.0;  // step in voxels, or tolerance
  double samples = 0.0;  // per ray, with skipping
  double samples_unskipped = 0.0;
  double error_rms = 0.0, error_p99 = 0.0;  // of a ray's colour and opacity, 0 … 1
};

/// Samples that fixed steps take per sample of adaptive ones, at the same RMS error and rule; 0 where
/// adaptive steps do not reach the error, NaN where fixed ones do not.
struct AdaptiveSaving {
  std::string scene, rule;
  double error = 0.0;
  double ratio = 0.0, ratio_unskipped = 0.0;
  double ratio_best_fixed = 0.0;  // against whichever rule of fixed steps takes the fewest
};

struct IntegratorBenchResult {
  std::string device;
  std::vector<WorkPrecision> points;
  std::vector<AdaptiveSaving> savings;
  double median_ratio = 0.0, median_ratio_unskipped = 0.0, median_ratio_best_fixed = 0.0;
  std::size_t real_volumes = 0;
};

/// Work and precision of cast/dvr's integrators with fixed and adaptive steps.
IntegratorBenchResult bench_integrators(const IntegratorBenchOptions& options);
std::string to_text(const IntegratorBenchResult& result);
std::string to_json(const IntegratorBenchResult& result);

}  // namespace brace
