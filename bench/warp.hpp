#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// What each warp costs beside the plain copy (warp/none without a lens), and what it brings: a head that has
/// moved on since the eye frame was rendered, against an ideal render from where it is.
struct WarpBenchOptions {
  gpu::DeviceOptions device;
  std::filesystem::path data_folder;
  StageRegistry stages;
  double resolution_scale = 0.5;
  int repetitions = 15;
};

struct WarpBenchRow {
  std::string warp, motion;
  double over_copy = 0;       // device time, median over the copy's
  double over_cast = 0;       // over that of a cast of the scene
  double cast_over_cast = 0;  // a cast that makes what the warp takes, over a plain one
  std::uint64_t texels = 0;   // counted work of the warp
  double dssim = 0;           // mean of both eyes
  double filled_percent = 0, uncovered_percent = 0;  // of the panels' pixels
};

struct WarpBenchResult {
  std::string device;
  int repetitions = 0;
  double host_load = 0;
  double copy_ms = 0, cast_ms = 0;
  std::vector<WarpBenchRow> rows;
};

WarpBenchResult bench_warp(const WarpBenchOptions& options);

std::string to_text(const WarpBenchResult& result);
std::string to_json(const WarpBenchResult& result);

}  // namespace brace
