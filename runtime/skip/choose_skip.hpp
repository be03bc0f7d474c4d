#pragma once

#include <cstdint>
#include <string>

#include "runtime/skip/skip_structure.hpp"

namespace brace {

/// What the choice is made from.
struct SkipQuestion {
  const VolumeInfo& volume;
  const VoxelStatistics& statistics;
  const TransferTable& table;
  bool table_changes = false;          // does the transfer function change while frames are shown?
  std::uint64_t memory_bytes_max = 0;  // that a structure may take; 0: no limit
};

struct SkipChoice {
  SkipOptions options;
  std::string reason;  // one line for the report
};

/// Share of visible voxels from which on looking up is taken to cost more than the samples it saves. An
/// assumption: `brace bench skip` measures the frame times to set it from.
inline constexpr double occupancy_worth_skipping = 0.6;

/// The cheapest structure for a scene, or none. Wanted: distances (fewest samples). From the least memory to
/// the cheapest change: distance_map if the transfer function stays; partitioned with a segment tree,
/// partitioned, bitmask, distance_map, as the memory allows, if it changes.
SkipChoice choose_skip(const SkipQuestion& question);

}  // namespace brace
