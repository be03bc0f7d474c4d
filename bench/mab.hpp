#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// rays/mab: what is saved, what it costs in error, and load control over it. Scenes fill the view, so that
/// rays are work.
struct MabBenchOptions {
  gpu::DeviceOptions device;
  std::filesystem::path data_folder;
  StageRegistry stages;
  std::vector<std::string> profiles = {"htc-vive", "oculus-cv1", "oculus-dk2", "psvr", "cardboard-v2"};
  std::vector<std::string> volumes = {"generator:fractal_vessels:128", "generator:marschner_lobb:96"};
  double resolution_scale = 0.3;
  int repetitions = 9;
  std::vector<std::string> parts = {"atlases", "errors", "times", "controls"};
  std::function<void(std::string_view)> progress = [](std::string_view) {};
};

/// The paper's scale ratios packed for a profile.
struct MabAtlasRow {
  std::string profile;
  std::int64_t used = 0, packed = 0, fixed = 0;  // texels
};

/// One picture against a ray per pixel, both after the lens.
struct MabErrorRow {
  std::string profile, volume, map;
  double ray_share = 0;      // rays over the pixels of both eyes
  double dssim = 0;          // mean of both eyes
  double weighted_rmse = 0;  // pixels by what the eye resolves there with a gaze straight ahead: GazeWeights
};

/// The lens' map against the radial one at equal rays, by linear interpolation between the nearest steps of
/// each map's ray counts.
struct MabMapRow {
  std::string profile, volume;
  double ratio_mean = 0, ratio_worst = 0;        // DSSIM lens / radius; below 1: the lens' is better
  double weighted_mean = 0, weighted_worst = 0;  // the same of weighted_rmse, lens_eccentricity / radius
};

struct MabTimeRow {
  std::string map, scheme;
  double ray_share = 0;   // rays cast over those of a ray per pixel, as counted
  double time_share = 0;  // device time of opening, cast and closing, median, over a ray per pixel's
};

/// 3,000 vsyncs; a ray per pixel takes half of the budget at first; 5 % noise.
struct MabControlRow {
  std::string control;
  double missed_percent = 0;
  std::int64_t longest_run = 0;
  double ray_share_mean = 0;  // of the eye frames
  /// step: ten times the load in the middle third; transfer function: another load (1, 4, 2, 8 times) every 4
  /// s; zoom: ten times and back in 6 s each way.
  std::string load;
  std::string schedule;              // whole_frame, or chunked with give_up_periods = 1
  double repeated_percent = 0;       // vsyncs that show the same eye frame as the one before, warped or not
  std::int64_t longest_repeats = 0;  // of them one after the other
};

struct MabBenchResult {
  std::string device;
  int repetitions = 0;
  double host_load = 0;
  std::vector<MabAtlasRow> atlases;
  std::vector<MabErrorRow> errors;
  std::vector<MabMapRow> maps;
  std::vector<MabTimeRow> times;
  std::vector<MabControlRow> controls;
};

MabBenchResult bench_mab(const MabBenchOptions& options);

/// On simulated time alone.
std::vector<MabControlRow> mab_control_rows(const StageRegistry& stages);

std::string to_text(const MabBenchResult& result);
std::string to_json(const MabBenchResult& result);

}  // namespace brace
