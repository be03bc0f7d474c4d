#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/raycast_scene.hpp"
#include "runtime/gpu/device.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// How ray casting scales with threads, with the picture, with the volume and with the share of it that is
/// empty: the benchmark scene (raycast_scene.hpp) by cast/native and cast/dvr. Times are of the cast alone,
/// without opening and closing brace, the shortest of the repetitions; CPU times of all threads (0: not
/// done on the CPU) change less on a busy machine.
struct ScalingBenchOptions {
  struct Picture {
    int width_px = 0, height_px = 0;
  };

  gpu::DeviceOptions device;
  std::filesystem::path data_folder;  // share/brace
  StageRegistry stages;               // where cast/native is looked for
  std::vector<std::string> parts = {"threads", "image", "volume", "empty"};
  int repetitions = 7;
  std::vector<Picture> thread_pictures = {{512, 512}, {1024, 1024}, {1080, 1200}};
  std::vector<int> image_edges_px = {128, 256, 512, 1024};
  std::vector<std::array<int, 3>> volumes = {
      {128, 128, 128}, {256, 256, 256}, {512, 512, 460}, {1024, 1024, 795}};  // first: base
  std::vector<double> empty_shares = {0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 0.97, 0.99, 0.999};
  int size_px = 512;                               // of the picture for volume and empty
  int edge_voxels = 256;                           // of the volume for threads, image and empty
  std::function<void(std::string_view)> progress;  // a line now and then
};

/// cast/native on threads. Speed-ups for `thread_counts` are simulated: each tile's cost is found by itself,
/// then tiles are given to threads (tile_schedule.hpp).
struct ScalingThreadsRow {
  int width_px = 0, height_px = 0;
  std::string transfer;
  bool skips = false;
  std::size_t tiles = 0;
  double ms_1 = 0, ms_2 = 0;              // measured
  double longest_tile_ratio = 0;          // its counted cost over that of all
  std::vector<double> speed_ups_counted;  // tiles cost what they count: samples, look-ups, rays
  std::vector<double> speed_ups_timed;    // tiles cost the time that they took on one thread
};

struct ScalingImageRow {
  int edge_px = 0;
  std::string renderer, transfer;
  bool skips = false;
  std::uint64_t rays = 0, samples = 0, skip_steps = 0;
  double ms = 0, cpu_ms = 0;
};

struct ScalingVolumeRow {
  std::array<int, 3> dims{};
  std::string renderer, transfer;
  bool is_chosen = true;           // false: a data path that the device does not take by itself
  bool same_distance = false;      // the picture grows with the volume
  int size_px = 0;                 // of the picture
  double ray_distance_voxels = 0;  // in the middle of the volume
  std::uint64_t samples = 0;
  double ms = 0, cpu_ms = 0;
};

struct ScalingEmptyRow {
  std::string renderer, transfer;
  double empty_ratio = 0;               // share of the voxels that the transfer function leaves invisible
  double none_ms = 0, distance_ms = 0;  // without and with a distance map
};

struct ScalingBenchResult {
  static constexpr std::array<int, 7> thread_counts = {1, 2, 4, 8, 16, 32, 64};
  static constexpr double volume_tolerance = 0.25;  // of the cost per sample, up and down

  std::string device;
  unsigned host_cores = 0;
  double host_load = 0;  // load average of the last minute at the begin
  int repetitions = 0;
  int size_px = 0, edge_voxels = 0;
  std::vector<ScalingThreadsRow> threads;
  std::vector<ScalingImageRow> image;
  std::vector<ScalingVolumeRow> volume;
  std::vector<ScalingEmptyRow> empty;
  std::vector<std::string> notes;
};

/// Throws brace::Error (an unknown part, no device, missing data files). A volume that the device cannot hold
/// becomes a note.
ScalingBenchResult bench_scaling(const ScalingBenchOptions& options);

std::string to_text(const ScalingBenchResult& result);
std::string to_json(const ScalingBenchResult& result);

}  // namespace brace
