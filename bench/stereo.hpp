#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/timeline/cost_model.hpp"

namespace brace {

/// Single-pass stereo against two passes over a turn about the volume: the time it saves, on the device and
/// on a GPU's cost model, and what it costs in error (Buchacher 2017, sections 4 and 6.1).
struct StereoBenchOptions {
  gpu::DeviceOptions device;
  std::filesystem::path data_folder;
  StageRegistry stages;
  CostModel model;  // prices the counted work
  std::vector<std::string> volumes = {"generator:solid_box:64", "generator:nested_shells:96",
                                      "generator:fractal_vessels:128"};
  std::string transfer_function = "ct-soft-tissue";
  double resolution_scale = 0.3;
  int views = 50;  // of 360 degrees
};

struct StereoBenchRow {
  std::string volume, shading, stereo;
  /// Time saved of the second eye, V = 1 - (T_pair - T_eye) / T_eye (eq. 23, T_eye half of two passes):
  /// medians over the views of the device's times; and of what the model makes of the counts.
  double saved_device = 0, saved_model = 0;
  double samples_share = 0;              // of those of two passes
  double dssim_mean = 0, dssim_max = 0;  // of the right eye's picture, against two passes
};

struct StereoBenchResult {
  std::string device, driver, model;
  int views = 0;
  double host_load = 0;
  std::vector<StereoBenchRow> rows;
};

StereoBenchResult bench_stereo(const StereoBenchOptions& options);

std::string to_text(const StereoBenchResult& result);
std::string to_json(const StereoBenchResult& result);

}  // namespace brace
