#pragma once

#include "bench/skip.hpp"
#include "runtime/skip/skip_structure.hpp"

namespace brace::bench {

struct NamedTable {
  int tf = 1;  // as in SkipFrameRow
  TransferTable table;
};

/// TF1 … TF6 over [0, 255].
std::vector<NamedTable> paper_tables();
/// For a volume of any values: what shows the highest 1 % of its voxels, TF1 and TF3 over its range.
std::vector<NamedTable> tables_for(const VoxelStatistics& statistics);

struct FrameVariant {
  std::string name;
  SkipOptions options;
};
std::vector<FrameVariant> all_variants();    // every structure
std::vector<FrameVariant> basic_variants();  // none, block, distance_map

/// Figs. 4 and 5: frame times of a volume with every structure, the camera on two full rotations about the
/// vertical axis, the volume as high as the picture; with and without early termination.
std::vector<SkipFrameRow> measure_frames(const gpu::Device& device, SkipKernels& kernels,
                                         const std::string& scene, const VolumeOnDevice& volume,
                                         const VoxelStatistics& statistics,
                                         std::span<const NamedTable> tables,
                                         const std::vector<FrameVariant>& variants,
                                         const SkipBenchOptions& options);

}  // namespace brace::bench
