#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/volume/volume.hpp"

namespace brace {

/// A volume as 32-bit texels with an apron of edge voxels: texel (x, y, z) stands for the point (x, y, z) of
/// voxel coordinates, between voxels x - 1 and x. 8-bit: it holds the voxels (x - 1, y - 1), (x, y - 1),
/// (x - 1, y), (x, y) from the lowest byte up. 16-bit: it holds the voxels x - 1 and x of row y - 1. Float:
/// it holds voxel (x - 1, y - 1). Slice z holds voxels of slice z - 1. Voxels outside are the nearest inside.
struct PackedLayout {
  explicit PackedLayout(const VolumeInfo& volume);

  VoxelType type = VoxelType::uint8;
  int dims[3] = {1, 1, 1};  // of the volume
  std::uint32_t row_texels = 0;
  std::uint32_t rows = 0;    // per slice
  std::uint32_t slices = 0;  // dims[2] + 2
  std::uint64_t slice_texels = 0;

  std::uint64_t texels() const { return slice_texels * slices; }
  std::uint64_t bytes() const { return texels() * 4; }
};

/// One slice of voxels (host byte order; int16 already biased) to the texels of one slice.
void pack_slice(const PackedLayout& layout, std::span<const std::byte> voxels,
                std::span<std::uint32_t> texels);

}  // namespace brace
