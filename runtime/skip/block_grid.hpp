#pragma once

#include <cstdint>

#include "runtime/volume/volume.hpp"

namespace brace {

/// Largest distance a map holds, in blocks; a byte's highest bit stays free (kernels/bytes.glsl).
inline constexpr int distance_max = 127;

/// The blocks of a volume and how maps and bit planes of them lie in memory. Block (x, y, z) holds the
/// samples at [block * edge, (block + 1) * edge) of voxel coordinates. A map is a byte per block, its rows
/// padded to 16 bytes; a plane is a bit per block, its rows padded to 32 bits. Maps and planes start at
/// multiples of `alignment_bytes`.
struct BlockGrid {
  static constexpr std::uint64_t alignment_bytes = 256;

  BlockGrid() = default;
  BlockGrid(const VolumeInfo& volume, int block_edge) : edge(block_edge) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      blocks[axis] = (static_cast<std::uint32_t>(volume.dims[axis]) + static_cast<std::uint32_t>(edge) - 1) /
                     static_cast<std::uint32_t>(edge);
  }

  int edge = 4;  // voxels
  std::uint32_t blocks[3] = {1, 1, 1};

  std::uint64_t count() const { return std::uint64_t{blocks[0]} * blocks[1] * blocks[2]; }
  std::uint32_t rows() const { return blocks[1] * blocks[2]; }

  std::uint32_t row_quads() const { return (blocks[0] + 15) / 16; }  // of 16 bytes, in a map
  std::uint32_t map_quads() const { return row_quads() * rows(); }
  std::uint64_t map_bytes() const { return aligned(std::uint64_t{map_quads()} * 16); }

  std::uint32_t row_words() const { return (blocks[0] + 31) / 32; }  // of 32 bits, in a plane
  std::uint32_t plane_words() const { return row_words() * rows(); }
  std::uint64_t plane_bytes() const { return aligned(std::uint64_t{plane_words()} * 4); }

  static std::uint64_t aligned(std::uint64_t bytes) {
    return (bytes + alignment_bytes - 1) / alignment_bytes * alignment_bytes;
  }
};

}  // namespace brace
