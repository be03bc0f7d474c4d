#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/volume/transfer_function.hpp"
#include "runtime/volume/volume.hpp"

namespace brace {

/// What is known of a volume's values. `range` is over finite voxels; {0, 0} if there are none.
struct VoxelStatistics {
  VoxelType type = VoxelType::uint8;
  ValueRange range;
  std::uint64_t voxels = 0;
  std::uint64_t not_finite = 0;

  /// 65,536 counts (256 for uint8) in the order of the values: one per value for the integer types, one per
  /// upper half of the bit pattern for float32, whose bins are thus at most 1/128 of their value wide.
  std::vector<std::uint64_t> counts;
};

/// The smallest and the largest value that falls into counts[bin].
ValueRange bin_range(VoxelType type, std::size_t bin);

/// Collects statistics slab by slab, while a volume is streamed.
class VoxelScan {
 public:
  explicit VoxelScan(VoxelType type);
  void add(std::span<const std::byte> voxels);  // whole voxels in host byte order
  VoxelStatistics result() const;

 private:
  VoxelStatistics statistics_;
};

VoxelStatistics scan(const Volume& volume);

/// Reads the rest of `source` through a slab of at most 16 MiB.
VoxelStatistics scan(VolumeSource& source, const Progress& progress = {});

/// Counts over `bins` equal bins of `range`, the last one closed; values outside are left out. Exact for
/// integer types; a float32 bin goes where its middle lies.
std::vector<std::uint64_t> histogram(const VoxelStatistics& statistics, ValueRange range, int bins);

/// Share of the voxels whose own value has an absorption above zero, 0 .. 1. Exact for integer types; an
/// upper bound for float32 (a bin counts if any value in it is visible).
double occupied_fraction(const VoxelStatistics& statistics, const TransferTable& table);

/// Exact for every type: each voxel goes through the table.
double occupied_fraction(const Volume& volume, const TransferTable& table);

}  // namespace brace
