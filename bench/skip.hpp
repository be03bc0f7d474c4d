#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/gpu/device.hpp"

namespace brace {

/// Table 1 and Figs. 4 and 5 of the PDM paper on generated volumes of the same sizes and similar occupancies.
struct SkipBenchOptions {
  gpu::DeviceOptions device;
  std::filesystem::path data_folder;  // share/brace: bench/, glsl/, kernels/, stages/
  std::vector<std::string> volumes;   // files or generators for frame times beside the generated ones
  std::vector<std::string> scenes = {"head", "insect", "snake"};
  std::vector<std::string> parts = {"updates", "frames", "threshold", "octants"};
  std::vector<int> partitions = {16, 32, 64, 128, 256};
  int divisor = 1;      // of the volumes' edges, to be quick
  int repetitions = 5;  // of each update; the least counts
  int viewport_px = 128;
  int views = 4;                                            // on two full rotations
  std::uint64_t memory_bytes_max = std::uint64_t{4} << 30;  // cells that need more are left out
  std::function<void(std::string_view)> progress;           // a line now and then
};

/// An update after a change of the transfer function, device time, least of the repetitions.
struct SkipUpdateRow {
  std::string scene;
  int tf = 1;
  double published_ms = 0;   // distance map as published: per-voxel occupancy, three-pass transform
  double recomputed_ms = 0;  // skip/distance_map: our best recomputation from the volume
  double block_ms = 0;
  double bitmask_ms = 0;  // 64 partitions
  struct Merge {
    int partitions = 0;
    int maps = 0;         // visible
    double merge_ms = 0;  // one pass
    double tree_ms = 0;   // segment tree; < 0: not run
    double paper_ms = 0;  // six at a time; < 0: not run
    double gb_per_s = 0;  // of the one-pass merge, read and written
  };
  std::vector<Merge> merges;
};

struct SkipInitRow {
  std::string scene;
  int partitions = 0;
  double all_ms = 0;     // one pass for the bits, transforms of all
  double single_ms = 0;  // one partition by the published method; times `partitions` is the rival
  double memory_mb = 0, bitmask_mb = 0;
};

struct SkipFrameRow {
  std::string scene;
  int tf = 1;  // 0: the highest 1 % of the voxels
  std::string stage;
  double ms = 0, ms_without_termination = 0;  // mean over the views
  double samples_m = 0, skip_steps_m = 0;     // per frame, with termination
  bool chosen = false;                        // by skip/auto
};

struct SkipThresholdRow {
  std::string content;  // of occupied blocks
  double occupied = 0;  // share of the blocks
  double none_ms = 0, block_ms = 0, distance_ms = 0;
};

/// Leaps per ray over empty blocks, mean; see bench/skip_octants.hpp.
struct SkipOctantRow {
  std::string scene;
  int tf = 1;
  double leaps_all = 0;     // one distance for all directions
  double leaps_octant = 0;  // one per octant: eight times the memory, and as many transforms
};

struct SkipBenchResult {
  std::string device;
  double host_load = 0;
  double copy_gb_per_s = 0;  // read and written
  std::vector<SkipInitRow> inits;
  std::vector<SkipUpdateRow> updates;
  std::vector<SkipFrameRow> frames;
  std::vector<SkipThresholdRow> thresholds;
  std::vector<SkipOctantRow> octants;
  std::vector<std::string> published;  // lines of Table 1
};

SkipBenchResult bench_skip(const SkipBenchOptions& options);

std::string to_text(const SkipBenchResult& result);
std::string to_json(const SkipBenchResult& result);
/// Plots: update times (Table 1) and frame times (Figs. 4 and 5).
std::string updates_svg(const SkipBenchResult& result);
std::string frames_svg(const SkipBenchResult& result);
/// Writes skip.txt, skip.json and the plots into a folder, which is made. Throws input_error if it cannot.
void write_skip_bench(const SkipBenchResult& result, const std::filesystem::path& folder);

}  // namespace brace
