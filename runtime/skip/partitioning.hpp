#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/volume/statistics.hpp"
#include "runtime/volume/transfer_function.hpp"

namespace brace {

// Keys are voxel values as unsigned integers in the order of the values, the bins of VoxelStatistics: 256 for
// uint8, 65,536 for the other types. For float32 a key stands for an interval of at most 1/128 of its value.

std::uint32_t key_count(VoxelType type);

/// The smallest key whose value, or largest value of its interval, is >= `value`; key_count if there is none.
std::uint32_t key_at_or_above(VoxelType type, double value);

/// The keys cut into runs: partition p holds the keys first_key[p] ... first_key[p + 1] - 1.
struct Partitioning {
  VoxelType type = VoxelType::uint8;
  std::vector<std::uint32_t> first_key;  // strictly increasing, from 0 to key_count(type)

  int count() const { return static_cast<int>(first_key.size()) - 1; }
  int partition_of(std::uint32_t key) const;
  /// Smallest and largest value in a partition.
  ValueRange range(int partition) const;
  bool operator==(const Partitioning&) const = default;
};

inline constexpr int max_partitions = 256;

/// `n` partitions (1 ... 256) of equal width over the values that occur; fewer where there are fewer keys.
Partitioning uniform_partitions(VoxelType type, ValueRange data_range, int n);

/// The smallest value by itself, and the others in n - 1 uniform partitions: helps where the smallest value
/// is the empty space around the object.
Partitioning minimum_apart(VoxelType type, ValueRange data_range, int n);

/// Borders where the transfer functions in use turn visible or invisible, so that each partition is all
/// visible or all invisible as far as n allows; the rest of the n borders cuts the fullest partitions by
/// their counts.
Partitioning adaptive_partitions(const VoxelStatistics& statistics, std::span<const TransferTable> tables,
                                 int n);

/// By how much rounding can put an interpolated value outside the interval of the voxels around it:
/// relative * |value + zero_shift| + absolute. Nothing for integer voxels interpolated in the kernel.
/// Relative where that holds, so that a background of zeros stays exactly zero.
struct Slack {
  double relative = 0.0, zero_shift = 0.0, absolute = 0.0;
};

/// Where a transfer table is visible, in the device's arithmetic.
class Visibility {
 public:
  explicit Visibility(const TransferTable& table, Slack slack = {});

  /// Does the table absorb anywhere in the closed interval?
  bool in(ValueRange range) const;

  /// By partition. A band that lies between two neighbouring integer values alone counts for the lower one.
  std::vector<bool> partitions(const Partitioning& partitioning) const;

  /// result[k]: visible keys below k; key_count + 1 entries.
  std::vector<std::uint32_t> visible_below(VoxelType type) const;

 private:
  bool visible_between_keys(VoxelType type, double low, double high) const;

  double scale_ = 1.0, offset_ = 0.0, last_ = 1.0;  // table coordinate = value * scale + offset
  Slack slack_;
  bool exact_ = true;                          // coordinates of integers are exact in the device's floats
  std::vector<std::uint32_t> positive_below_;  // positive_below_[i]: absorbing entries below i
};

/// The runs of true: [begin, end).
struct PartitionRun {
  int begin = 0, end = 0;
  bool operator==(const PartitionRun&) const = default;
};
std::vector<PartitionRun> runs_of(const std::vector<bool>& visible);

}  // namespace brace
