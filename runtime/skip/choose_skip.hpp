#pragma once

#include <cstdint>
#include <string>

#include "runtime/skip/skip_structure.hpp"

namespace brace {

/// What the choice is made from.
struct SkipQuestion {
  const VolumeInfo& volume;
  double occupied = 0.0;  // share of the blocks: occupied_blocks, the mean over the transfer functions in use
  const TransferTable& table;
  bool table_changes = false;          // does the transfer function change while frames are shown?
  std::uint64_t memory_bytes_max = 0;  // that a structure may take; 0: no limit
};

struct SkipChoice {
  SkipOptions options;
  std::string reason;  // one line for the report
};

/// Share of occupied blocks from which on looking up costs more than the samples it saves. Measured by `brace
/// bench skip` on scenes that are the worst for skipping: a single visible voxel in each occupied block, so
/// that nearly every sample is followed by a look-up in vain. There distances give 1.75x at 30 % and 0.96x at
/// 51 % (docs/benchmarks.md).
inline constexpr double occupancy_worth_skipping = 0.4;

/// The cheapest structure for a scene, or none. Wanted: distances (fewest samples). distance_map if the
/// transfer function stays; if it changes, from the cheapest change to the least memory: partitioned with a
/// segment tree, partitioned, bitmask, distance_map, as the memory allows.
SkipChoice choose_skip(const SkipQuestion& question);

/// Share of the blocks that a transfer function occupies, counted on the device.
double occupied_blocks(SkipKernels& kernels, const SkipScene& scene, const TransferTable& table,
                       int block_voxels = SkipOptions{}.block_voxels);

}  // namespace brace
