#pragma once

#include <vector>

#include "runtime/volume/statistics.hpp"
#include "runtime/volume/transfer_function.hpp"

namespace brace {

// Edits of a resolved transfer function's points; what comes out is valid.

/// Smallest distance of two points' values, of the range.
inline constexpr double value_gap = 1e-4;

/// Moves a point; it stays between its neighbours and within `range`. `opacity` is that of a voxel length, 0
/// to 1, clamped; 1 is opaque_optical_depth.
void move_point(TransferFunction& tf, std::size_t index, double value, double opacity, ValueRange range);

/// A new point on the curve; its index. Where a point is too near already, that one's.
std::size_t add_point(TransferFunction& tf, double value, ValueRange range);

/// The last one stays.
void remove_point(TransferFunction& tf, std::size_t index);

/// A histogram's bars for drawing, log(1 + count) over that of the largest, 0 to 1. The bin of the smallest
/// value, which holds the air around most volumes, does not set the scale where others are filled.
std::vector<float> log_bars(const VoxelStatistics& statistics, ValueRange range, int bins);

}  // namespace brace
