#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
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
  CostModel model;           // prices the counted work
  CostModel software_model;  // … as the software device would: its times on a busy machine say little
  std::vector<std::string> volumes = {"generator:solid_box:64", "generator:nested_shells:96",
                                      "generator:fractal_vessels:128"};
  std::string transfer_function = "ct-soft-tissue";
  double resolution_scale = 0.15;  // of the methods' table
  double ladder_scale = 0.1;       // of the tables of shading and layers: 64 fetches per sample take long
  std::vector<double> scales = {0.05, 0.1, 0.2};  // of the table of resolutions
  int views = 50;                                 // of 360 degrees
  std::vector<std::string> parts = {"methods", "shading", "layers", "resolution"};
  std::function<void(std::string_view)> progress;
};

struct StereoBenchRow {
  std::string part, volume, shading, stereo;
  double resolution_scale = 0;
  /// Time saved of the second eye, V = 1 - (T_pair - T_eye) / T_eye (eq. 23, T_eye half of two passes):
  /// medians over the views of the device's times; and of what the models make of the counts, at full
  /// resolution.
  double saved_device = 0, saved_model = 0, saved_software_model = 0;
  double samples_share = 0;  // of those of two passes
  double fetches_share = 0;  // of shading; 0 where nothing is fetched
  double texels_per_px = 0;  // of layers, 8 bytes read and 8 written each, over the right eye's pixels
  double layer_mib = 0;      // memory of re-projection layers
  double dssim_mean = 0, dssim_max = 0;  // of the right eye's picture, against two passes
  double dssim_left_mean = 0;            // of the left one: 0 where its rays are those of two passes
};

struct StereoBenchResult {
  std::string device, driver, model, software_model;
  int views = 0;
  double host_load = 0;
  std::vector<StereoBenchRow> rows;
};

/// Throws input_error for parts that there are not.
StereoBenchResult bench_stereo(const StereoBenchOptions& options);

std::string to_text(const StereoBenchResult& result);
std::string to_json(const StereoBenchResult& result);

}  // namespace brace
