#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// Ray casting: one eye of the benchmark scene (raycast_scene.hpp) with both transfer functions, by cast/dvr
/// on both data paths and by cast/native, without skipping and with a distance map, beside VTK's volume
/// mappers on the same voxels, camera, step and picture size.
struct RaycastBenchOptions {
  gpu::DeviceOptions device;
  std::filesystem::path data_folder;  // share/brace: glsl/, kernels/, stages/, bench/
  StageRegistry stages;               // where cast/native is looked for
  int repetitions = 9;                // of each case, half of them before and half after the rivals
  int size_px = 512;                  // width and height of the picture
  bool rivals = true;                 // measure VTK where it is installed
};

struct RaycastBenchCase {
  std::string renderer;
  std::string transfer;  // T or S
  bool is_rival = false;
  bool skips = false;          // empty space, by a distance map
  double frame_ms_median = 0;  // wall time of a frame
  double frame_ms_min = 0;
  double cpu_ms_min = 0;      // CPU time of all threads; 0 where the work is not done on the CPU
  std::uint64_t samples = 0;  // 0: not known
  double samples_per_s = 0;   // at the median
};

struct RaycastBenchResult {
  std::string device;
  std::string path_reason;  // which data path the device takes by itself, and why
  unsigned host_cores = 0;
  double host_load =
      0;  // load average of the last minute at the begin; near or above the cores: figures inflated
  int repetitions = 0;
  int size_px = 0;
  double zero_voxels_ratio = 0;
  std::vector<RaycastBenchCase> cases;  // the first is what the device takes by itself, with T
  std::vector<std::string> notes;       // rivals that could not be measured, and what to install
};

/// Throws brace::Error (no device, missing data files). A rival that is not there or fails becomes a note.
RaycastBenchResult bench_raycast(const RaycastBenchOptions& options);

/// Frame time of a rival over ours for the same transfer function, both at their minimum; 0 when one is
/// missing.
double raycast_ratio(const RaycastBenchResult& result, const RaycastBenchCase& rival);
/// The same for the CPU time of all threads.
double raycast_cpu_ratio(const RaycastBenchResult& result, const RaycastBenchCase& rival);

std::string to_text(const RaycastBenchResult& result);
std::string to_json(const RaycastBenchResult& result);

}  // namespace brace
