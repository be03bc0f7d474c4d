#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include <sys/mman.h>

#include "caster.hpp"

namespace native_cast {

namespace {

std::size_t bytes_of(brace_voxel_type type) {
  return type == BRACE_VOXEL_UINT8 ? 1 : type == BRACE_VOXEL_FLOAT32 ? 4 : 2;
}

/// Writes the texels of one slice; `tiles` is that slice of the first tile. Beyond the slice lies its edge.
/// `Voxel` tells how many rows a texel holds and whether it holds pairs along x.
template <typename Voxel>
void pack(const PackedVolume& volume, const unsigned char* voxels, const std::uint32_t (&dims)[3],
          std::uint32_t* tiles) {
  const std::ptrdiff_t across = dims[0], down = dims[1];
  const auto load = [&](std::ptrdiff_t row, std::ptrdiff_t x) {
    Voxel voxel;
    std::memcpy(&voxel, voxels + (row * across + x) * static_cast<std::ptrdiff_t>(sizeof voxel),
                sizeof voxel);
    return std::uint32_t{voxel};
  };
  for (std::ptrdiff_t y = 0; y < down + 2; ++y) {
    const std::ptrdiff_t upper = std::clamp<std::ptrdiff_t>(y - 1, 0, down - 1);
    const std::ptrdiff_t lower = std::min(y, down - 1);
    std::uint32_t* const row = tiles + (y >> 2) * volume.pitch[1] + (y & 3) * 4;
    for (std::ptrdiff_t x = 0; x < across + 2; ++x) {
      const std::ptrdiff_t left = std::clamp<std::ptrdiff_t>(x - 1, 0, across - 1);
      const std::ptrdiff_t right = std::min(x, across - 1);
      std::uint32_t texel = load(upper, left);
      if constexpr (sizeof(Voxel) == 1)
        texel |= load(upper, right) << 8 | load(lower, left) << 16 | load(lower, right) << 24;
      if constexpr (sizeof(Voxel) == 2) texel |= load(upper, right) << 16;
      row[(x >> 2) * volume.pitch[0] + (x & 3)] = texel;
    }
  }
}

/// Signed voxels are kept with an offset of 32768, which the eye parameters take away again.
void bias(std::vector<unsigned char>& raw) {
  for (std::size_t i = 1; i < raw.size(); i += 2)
    raw[i] ^= 0x80u;
}

}  // namespace

Texels::Texels(std::size_t count) : size_(count) {
  constexpr std::size_t huge_page = std::size_t{2} << 20;
  const std::size_t bytes = (count * sizeof(std::uint32_t) + huge_page - 1) / huge_page * huge_page;
  memory_.reset(static_cast<std::uint32_t*>(std::aligned_alloc(huge_page, bytes)));
  if (memory_ == nullptr) throw std::bad_alloc();
  (void)madvise(memory_.get(), bytes, MADV_HUGEPAGE);  // a wish; without it everything is slower, not wrong
}

void Texels::Free::operator()(std::uint32_t* memory) const {
  std::free(memory);
}

brace_result PackedVolume::read(const brace_volume& volume, std::string& error) {
  type = volume.type;
  const std::uint64_t slices = std::uint64_t{volume.dims[2]} + 2;
  const std::uint64_t tiles_across = (std::uint64_t{volume.dims[0]} + 2 + 3) / 4;
  const std::uint64_t tiles_down = (std::uint64_t{volume.dims[1]} + 2 + 3) / 4;
  const std::uint64_t total = slices * tile_slice_texels * tiles_across * tiles_down;
  if (total > std::numeric_limits<std::int32_t>::max()) {
    error = "the volume has too many voxels: accepted are up to 2^31 with the apron";
    return BRACE_UNSUPPORTED;
  }
  for (int axis = 0; axis < 3; ++axis)
    last_cell[axis] = static_cast<std::int32_t>(volume.dims[axis]);
  pitch[0] = static_cast<std::int32_t>(slices * tile_slice_texels);
  pitch[1] = static_cast<std::int32_t>(slices * tile_slice_texels * tiles_across);
  texels = Texels(total);
  const std::size_t voxels = std::size_t{volume.dims[0]} * volume.dims[1];
  std::vector<unsigned char> raw(voxels * bytes_of(type));
  for (std::uint32_t z = 0; z < volume.dims[2]; ++z) {
    const brace_result result = volume.read_slices(&volume, z, 1, raw.data(), raw.size());
    if (result != BRACE_OK) {
      error = "the volume's voxels could not be read";
      return result;
    }
    if (type == BRACE_VOXEL_INT16) bias(raw);
    const auto pack_as = type == BRACE_VOXEL_UINT8     ? pack<std::uint8_t>
                         : type == BRACE_VOXEL_FLOAT32 ? pack<std::uint32_t>
                                                       : pack<std::uint16_t>;
    pack_as(*this, raw.data(), volume.dims, texels.data() + (std::size_t{z} + 1) * tile_slice_texels);
  }
  const auto copy_slice = [&](std::uint32_t* tile, std::uint64_t from, std::uint64_t to) {
    std::copy_n(tile + from * tile_slice_texels, tile_slice_texels, tile + to * tile_slice_texels);
  };
  for (std::uint32_t* tile = texels.data(); tile != texels.data() + total; tile += pitch[0]) {
    copy_slice(tile, 1, 0);
    copy_slice(tile, slices - 2, slices - 1);
  }
  return BRACE_OK;
}

}  // namespace native_cast
