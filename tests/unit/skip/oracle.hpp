#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/skip/bit_planes.hpp"
#include "runtime/skip/block_grid.hpp"
#include "runtime/skip/partitioning.hpp"
#include "runtime/volume/transfer_function.hpp"
#include "runtime/volume/volume.hpp"

// What the kernels of runtime/skip are held against: written from the definitions, in double precision, by
// brute force.
namespace brace::oracle {

/// Closed intervals of the values that interpolation can give in a block, by the definition of occupancy.
std::vector<ValueRange> block_intervals(const Volume& volume, const BlockGrid& grid, std::array<int, 3> block,
                                        Occupancy occupancy);

/// Is the table's absorption positive anywhere in [min, max]? Looked up at the ends and at every entry
/// between.
bool absorbs_in(const TransferTable& table, ValueRange range);

/// A value per block, x fastest, not padded.
using BlockValues = std::vector<int>;

/// 1 for the occupied blocks.
BlockValues occupied(const Volume& volume, const BlockGrid& grid, const TransferTable& table,
                     Occupancy occupancy);

/// 1 for the blocks that have an interval which meets the partition's values.
BlockValues in_partition(const Volume& volume, const BlockGrid& grid, const Partitioning& partitioning,
                         int partition, Occupancy occupancy);

/// min over occupied y of ||x - y||_inf, at most distance_max.
BlockValues chebyshev(const BlockGrid& grid, const BlockValues& occupied);

}  // namespace brace::oracle
