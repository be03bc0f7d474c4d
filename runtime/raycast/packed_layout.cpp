#include "runtime/raycast/packed_layout.hpp"

#include <algorithm>
#include <cstring>

#include "base/error.hpp"

namespace brace {

namespace {

std::uint32_t aproned(int dim, bool pairs) {
  return static_cast<std::uint32_t>(dim) + (pairs ? 1u : 2u);
}

/// The row of voxels, as `Voxel`s, that texel row y stands for; clamped to the edge.
template <typename Voxel>
const Voxel* row_at(const PackedLayout& layout, std::span<const std::byte> voxels, int y) {
  const int row = std::clamp(y, 0, layout.dims[1] - 1);
  return reinterpret_cast<const Voxel*>(voxels.data()) +
         static_cast<std::ptrdiff_t>(row) * static_cast<std::ptrdiff_t>(layout.dims[0]);
}

/// Calls texel(low, high, x) with the voxels left and right of each texel of a row, clamped to the edge.
template <typename Voxel, typename Texel>
void for_each_pair(const PackedLayout& layout, const Voxel* row, const Texel& texel) {
  const int last = layout.dims[0] - 1;
  texel(row[0], row[0], 0);
  for (int x = 1; x <= last; ++x)
    texel(row[x - 1], row[x], x);
  texel(row[last], row[last], last + 1);
}

void pack_8(const PackedLayout& layout, std::span<const std::byte> voxels, std::uint32_t* out) {
  for (std::uint32_t y = 0; y < layout.rows; ++y, out += layout.row_texels) {
    for_each_pair(layout, row_at<std::uint8_t>(layout, voxels, static_cast<int>(y) - 1),
                  [&](std::uint32_t low, std::uint32_t high, int x) { out[x] = low | high << 8; });
    for_each_pair(layout, row_at<std::uint8_t>(layout, voxels, static_cast<int>(y)),
                  [&](std::uint32_t low, std::uint32_t high, int x) { out[x] |= low << 16 | high << 24; });
  }
}

void pack_16(const PackedLayout& layout, std::span<const std::byte> voxels, std::uint32_t* out) {
  for (std::uint32_t y = 0; y < layout.rows; ++y, out += layout.row_texels) {
    for_each_pair(layout, row_at<std::uint16_t>(layout, voxels, static_cast<int>(y) - 1),
                  [&](std::uint32_t low, std::uint32_t high, int x) { out[x] = low | high << 16; });
  }
}

void pack_32(const PackedLayout& layout, std::span<const std::byte> voxels, std::uint32_t* out) {
  for (std::uint32_t y = 0; y < layout.rows; ++y, out += layout.row_texels) {
    const auto* row = row_at<std::uint32_t>(layout, voxels, static_cast<int>(y) - 1);
    out[0] = row[0];
    std::memcpy(out + 1, row, static_cast<std::size_t>(layout.dims[0]) * 4);
    out[layout.row_texels - 1] = row[layout.dims[0] - 1];
  }
}

}  // namespace

PackedLayout::PackedLayout(const VolumeInfo& volume) : type(volume.type) {
  std::copy(volume.dims.begin(), volume.dims.end(), dims);
  row_texels = aproned(dims[0], type != VoxelType::float32);
  rows = aproned(dims[1], type == VoxelType::uint8);
  slices = aproned(dims[2], false);
  slice_texels = std::uint64_t{row_texels} * rows;
}

void pack_slice(const PackedLayout& layout, std::span<const std::byte> voxels,
                std::span<std::uint32_t> texels) {
  BRACE_CHECK(texels.size() == layout.slice_texels);
  switch (layout.type) {
    case VoxelType::uint8:
      return pack_8(layout, voxels, texels.data());
    case VoxelType::int16:
    case VoxelType::uint16:
      return pack_16(layout, voxels, texels.data());
    case VoxelType::float32:
      return pack_32(layout, voxels, texels.data());
  }
}

}  // namespace brace
