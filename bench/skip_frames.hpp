#pragma once

#include "bench/skip.hpp"
#include "runtime/skip/skip_structure.hpp"

namespace brace::bench {

/// Figs. 4 and 5: frame times of a volume with every structure, the camera on two full rotations about the
/// vertical axis, the volume as high as the picture; with and without early termination.
std::vector<SkipFrameRow> measure_frames(const gpu::Device& device, SkipKernels& kernels,
                                         const std::string& scene, const VolumeOnDevice& volume,
                                         const VoxelStatistics& statistics, std::span<const int> tfs,
                                         const SkipBenchOptions& options);

}  // namespace brace::bench
