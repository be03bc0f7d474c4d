#pragma once

#include <vector>

#include "bench/skip.hpp"
#include "runtime/skip/skip_kernels.hpp"

namespace brace::bench {

/// Frame times over the share of occupied blocks, from which choose_skip's threshold is taken. "dust": a
/// single visible voxel in an occupied block, so that nearly every sample there is followed by a look-up in
/// vain, the worst for skipping. "solid": every sample there is visible and none is.
std::vector<SkipThresholdRow> measure_thresholds(const gpu::Device& device, SkipKernels& kernels,
                                                 const SkipBenchOptions& options);

}  // namespace brace::bench
