#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"

namespace brace {

/// The display pass on its own: HTC Vive lens, both eyes of 960 x 1080 pixels (1920 x 1080 in all), eye
/// frames 1.4 times as wide and high, of smooth colours.
struct DistortBenchOptions {
  gpu::DeviceOptions device;
  std::filesystem::path data_folder;  // share/brace: devices/, glsl/, kernels/, stages/
  int repetitions = 60;               // of each case, interleaved; after three to warm up
};

struct DistortBenchCase {
  std::string name;
  std::string help;
  double device_ns_per_px_median = 0;  // device time over the pixels of both panels, hidden ones counted
  double device_ns_per_px_min = 0;
  double cpu_ns_per_px_median = 0;  // CPU time of all threads together; only where the device is software
  double gb_per_s = 0;              // eye frames read once and panel pixels written, at the median
  double pixels_written_ratio = 1;  // less than 1 where hidden tiles are left out
};

struct DistortBenchResult {
  std::string device;
  bool is_software = false;
  unsigned host_cores = 0;
  double host_load =
      0;  // load average of the last minute when the run began; above 1 the figures are inflated
  int repetitions = 0;
  std::int64_t panel_pixels = 0;        // both eyes
  std::int64_t source_pixels = 0;       // both eyes
  std::vector<DistortBenchCase> cases;  // the first is the one to compare
};

/// Throws brace::Error (no device, missing data files).
DistortBenchResult bench_distort(const DistortBenchOptions& options);

/// Both name the rivals' published figures beside ours, as published, and the ratio.
std::string to_text(const DistortBenchResult& result);
std::string to_json(const DistortBenchResult& result);

}  // namespace brace
