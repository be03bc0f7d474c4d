#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/timeline/cost_model.hpp"

namespace brace {

/// Measures casts and warps of different sizes, shading and skipping on the device at hand and fits a cost
/// model to their counted work: what `clock.cost = "model:NAME"` needs for a new device.
struct CostBenchOptions {
  gpu::DeviceOptions device;
  std::filesystem::path data_folder;  // share/brace
  StageRegistry stages;
  int repetitions = 5;  // of each job; the least counts
};

struct CostBenchResult {
  std::string device, driver;
  double host_load = 0;  // load average of the last minute at the begin; near or above the cores: inflated
  std::vector<CostSample> samples;
  CostFit fit;
};

CostBenchResult bench_costs(const CostBenchOptions& options);

/// The fitted model as the text of a share/brace/costs file, with the fit's error in its comments.
std::string to_text(const CostBenchResult& result);
std::string to_json(const CostBenchResult& result);

}  // namespace brace
