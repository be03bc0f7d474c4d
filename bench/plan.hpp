#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// What the planner's thresholds stand on (runtime/plan/plan.hpp).
struct PlanBenchOptions {
  gpu::DeviceOptions device;
  std::filesystem::path data_folder;
  StageRegistry stages;
  std::vector<std::string> volumes = {"generator:nested_shells:96", "generator:fractal_vessels:128",
                                      "generator:marschner_lobb:96"};
  std::vector<std::string> transfer_functions = {"mri-brain", "ct-bone", "tf3"};
  double resolution_scale = 0.3;
  int repetitions = 40;
};

/// A picture whose head pose is off by some pixels against that of the true pose.
struct PlanOffRow {
  std::string volume, transfer_function;
  double off_px = 0.0;  // as rendered
  double dssim = 0.0;   // mean of both eyes
};

/// A picture without pre-integration against that with it, and both against one of a quarter of the step.
struct PlanIntegratorRow {
  std::string volume, transfer_function;
  double change_dssim = 0.0;         // without against with: what the planner sees
  double error_with_dssim = 0.0;     // against the small steps
  double error_without_dssim = 0.0;  // against the small steps: what it wants to know
};

/// A picture that is scanned out while the head turns, every row shown from the pose that it is rendered for,
/// against one that is shown at once: what a rolling panel does to an eye frame that nobody corrects.
struct PlanScanOutRow {
  std::string volume, transfer_function;
  double scan_out_px = 0.0;  // that the view moves by from the first row to the last, as rendered
  double dssim = 0.0;        // mean of both eyes
};

struct PlanBenchResult {
  std::string device, driver;
  std::vector<PlanOffRow> off;
  std::vector<PlanIntegratorRow> integrators;
  double noise_share =
      0.0;  // p95 of how far medians of six eye frames' device times differ from their own median
  std::vector<PlanScanOutRow> scan_out;
};

PlanBenchResult bench_plan(const PlanBenchOptions& options);

std::string to_text(const PlanBenchResult& result);
std::string to_json(const PlanBenchResult& result);

}  // namespace brace
