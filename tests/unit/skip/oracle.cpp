#include "skip/oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brace::oracle {

namespace {

template <typename Visit>
void for_each_block(const BlockGrid& grid, const Visit& visit) {
  const int bx = static_cast<int>(grid.blocks[0]), by = static_cast<int>(grid.blocks[1]);
  const int bz = static_cast<int>(grid.blocks[2]);
  for (int z = 0; z < bz; ++z)
    for (int y = 0; y < by; ++y)
      for (int x = 0; x < bx; ++x)
        visit(std::array<int, 3>{x, y, z}, static_cast<std::size_t>((z * by + y) * bx + x));
}

double clamped_value(const Volume& volume, int x, int y, int z) {
  const auto& dims = volume.info.dims;
  return voxel_value(volume, std::clamp(x, 0, dims[0] - 1), std::clamp(y, 0, dims[1] - 1),
                     std::clamp(z, 0, dims[2] - 1));
}

/// The interval of the cell with lower corner (x, y, z); a corner that is no number leaves nothing out.
ValueRange cell_interval(const Volume& volume, int x, int y, int z) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  ValueRange range{infinity, -infinity};
  for (int corner = 0; corner < 8; ++corner) {
    const double value = clamped_value(volume, x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
    if (!std::isfinite(value)) return {-infinity, infinity};
    range = {std::min(range.min, value), std::max(range.max, value)};
  }
  return range;
}

}  // namespace

std::vector<ValueRange> block_intervals(const Volume& volume, const BlockGrid& grid, std::array<int, 3> block,
                                        Occupancy occupancy) {
  std::vector<ValueRange> intervals;
  const auto& dims = volume.info.dims;
  const int below = occupancy == Occupancy::voxel ? 0 : 1;
  std::array<int, 3> begin{}, end{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    begin[axis] = block[axis] * grid.edge - below;
    end[axis] = std::min((block[axis] + 1) * grid.edge, dims[axis]);
  }
  for (int z = begin[2]; z < end[2]; ++z)
    for (int y = begin[1]; y < end[1]; ++y)
      for (int x = begin[0]; x < end[0]; ++x) {
        if (occupancy == Occupancy::voxel) {
          const double value = voxel_value(volume, x, y, z);
          intervals.push_back({value, value});
        } else {
          intervals.push_back(cell_interval(volume, x, y, z));
        }
      }
  if (occupancy == Occupancy::block) {
    ValueRange all = intervals.front();
    for (const ValueRange& range : intervals)
      all = {std::min(all.min, range.min), std::max(all.max, range.max)};
    intervals = {all};
  }
  return intervals;
}

bool absorbs_in(const TransferTable& table, ValueRange range) {
  const auto last = static_cast<double>(table.entries.size() - 1);
  const double scale = last / (table.range.max - table.range.min);
  if (lookup(table, std::max(range.min, table.range.min)).kappa > 0 && range.min <= range.max) return true;
  if (lookup(table, std::min(range.max, table.range.max)).kappa > 0) return true;
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    const double value = table.range.min + static_cast<double>(i) / scale;
    if (value >= range.min && value <= range.max && table.entries[i][3] > 0) return true;
  }
  return false;
}

BlockValues occupied(const Volume& volume, const BlockGrid& grid, const TransferTable& table,
                     Occupancy occupancy) {
  BlockValues result(grid.count());
  for_each_block(grid, [&](std::array<int, 3> block, std::size_t at) {
    for (const ValueRange& range : block_intervals(volume, grid, block, occupancy))
      if (absorbs_in(table, range)) result[at] = 1;
  });
  return result;
}

BlockValues in_partition(const Volume& volume, const BlockGrid& grid, const Partitioning& partitioning,
                         int partition, Occupancy occupancy) {
  const ValueRange values = partitioning.range(partition);
  BlockValues result(grid.count());
  for_each_block(grid, [&](std::array<int, 3> block, std::size_t at) {
    for (const ValueRange& range : block_intervals(volume, grid, block, occupancy))
      if (range.min <= values.max && range.max >= values.min) result[at] = 1;
  });
  return result;
}

BlockValues chebyshev(const BlockGrid& grid, const BlockValues& occupied) {
  BlockValues result(grid.count(), distance_max);
  for_each_block(grid, [&](std::array<int, 3> from, std::size_t) {
    const std::size_t there = static_cast<std::size_t>(from[0]) +
                              grid.blocks[0] * (static_cast<std::size_t>(from[1]) +
                                                grid.blocks[1] * static_cast<std::size_t>(from[2]));
    if (occupied[there] == 0) return;
    for_each_block(grid, [&](std::array<int, 3> to, std::size_t at) {
      const int distance =
          std::max({std::abs(from[0] - to[0]), std::abs(from[1] - to[1]), std::abs(from[2] - to[2])});
      result[at] = std::min(result[at], distance);
    });
  });
  return result;
}

}  // namespace brace::oracle
