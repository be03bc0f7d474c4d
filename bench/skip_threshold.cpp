#include "bench/skip_threshold.hpp"

#include <algorithm>

#include "bench/skip_frames.hpp"
#include "bench/skip_scenes.hpp"
#include "runtime/skip/choose_skip.hpp"

namespace brace::bench {

namespace {

constexpr int clump_blocks = 2;  // occupied blocks come in cubes of so many

/// Blocks of 4 voxels of which a share is occupied.
class ShareSource final : public VolumeSource {
 public:
  ShareSource(VolumeInfo info, double share, bool solid)
      : VolumeSource(std::move(info)), below_(share * 256.0), solid_(solid) {}

 private:
  void produce(std::span<std::byte> out, int z_begin, int z_count) override {
    const auto [nx, ny, nz] = info().dims;
    std::size_t at = 0;
    for (int z = z_begin; z < z_begin + z_count; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x)
          out[at++] = std::byte{occupied(x, y, z) ? std::uint8_t{200} : std::uint8_t{0}};
  }

  bool occupied(int x, int y, int z) const {
    constexpr int edge = 4 * clump_blocks;
    if (noise(x / edge, y / edge, z / edge) >= below_) return false;
    return solid_ || (x % 4 == 2 && y % 4 == 2 && z % 4 == 2);
  }

  double below_;
  bool solid_;
};

}  // namespace

std::vector<SkipThresholdRow> measure_thresholds(const gpu::Device& device, SkipKernels& kernels,
                                                 const SkipBenchOptions& options) {
  VolumeInfo info;
  const int edge = std::max(160 / options.divisor, 32);
  info.dims = {edge, edge, edge};
  info.source = "benchmark scene of a share of occupied blocks";
  TransferTable table = skip_table(1);
  for (auto& entry : table.entries)
    entry[3] *= 0.01;  // nearly transparent: no ray ends early
  const NamedTable tables[] = {{1, table}};
  std::vector<SkipThresholdRow> rows;
  for (const bool solid : {false, true}) {
    for (const double share : {0.1, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}) {
      ShareSource source(info, share, solid);
      VoxelScan scan(VoxelType::uint8);
      const VolumeOnDevice volume(device, source, VolumePath::automatic, &scan);
      const VoxelStatistics statistics = scan.result();
      SkipThresholdRow row;
      row.content = solid ? "solid" : "dust";
      row.occupied = occupied_blocks(kernels, {volume, statistics}, table);
      for (const SkipFrameRow& frame : measure_frames(device, kernels, row.content, volume, statistics,
                                                      tables, basic_variants(), options)) {
        if (frame.stage == "none") row.none_ms = frame.ms;
        if (frame.stage == "block") row.block_ms = frame.ms;
        if (frame.stage == "distance_map") row.distance_ms = frame.ms;
      }
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace brace::bench
