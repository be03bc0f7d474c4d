// Cells of a packet whose rays lie near to each other: the texels around all of them, shared out by
// permutation. Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_NEAR_CELLS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_NEAR_CELLS_INL
#undef NATIVE_CAST_NEAR_CELLS_INL
#else
#define NATIVE_CAST_NEAR_CELLS_INL
#endif

#include <hwy/highway.h>

#include "beam-inl.hpp"
#include "lanes-inl.hpp"
#include "voxels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

/// Whether cells of a type can be fetched so: a vector holds a slice of a tile.
template <brace_voxel_type type>
constexpr bool has_near_cells = type == BRACE_VOXEL_UINT8&& HWY_TARGET == HWY_AVX3;

/// The widest box of points whose cells lie in two tiles along each axis at most.
constexpr float near_voxels = 4.0f;

/// The cells around points that all lie in `box`; lanes whose points do not get anything.
template <brace_voxel_type type>
Cell<type> near_cell(const PackedVolume& volume, const Point& voxel, const Box& box);

#if HWY_TARGET == HWY_AVX3

/// Two by two tiles that a box meets, from its first slice to its last.
struct NearTiles {
  const std::uint32_t* texels;  // of the first tile's first slice
  std::ptrdiff_t right, lower;  // to the other tiles; 0 where the box meets one only
  std::int32_t x, y;            // of the first tile's first column
  std::int32_t first, last;     // slices; the one after the last exists
};

HWY_INLINE NearTiles near_tiles(const PackedVolume& volume, const Box& box) {
  const __m256i end =
      _mm256_broadcastsi128_si256(_mm_load_si128(reinterpret_cast<const __m128i*>(volume.last_cell)));
  const __m256i at = _mm256_cvttps_epi32(_mm256_add_ps(_mm256_load_ps(box.corner), _mm256_set1_ps(0.5f)));
  const __m256i cell = _mm256_max_epi32(_mm256_min_epi32(at, end), _mm256_setzero_si256());
  alignas(32) std::int32_t corner[8];
  _mm256_store_si256(reinterpret_cast<__m256i*>(corner), cell);
  const std::int32_t x = corner[0] >> 2, y = corner[1] >> 2;
  return {volume.texels.data() + std::ptrdiff_t{x} * volume.tile_texels +
              std::ptrdiff_t{y} * volume.tile_row_texels + corner[2] * PackedVolume::tile_slice_texels,
          ((corner[4] >> 2) - x) * std::ptrdiff_t{volume.tile_texels},
          ((corner[5] >> 2) - y) * std::ptrdiff_t{volume.tile_row_texels},
          4 * x,
          4 * y,
          corner[2],
          corner[6]};
}

template <>
HWY_INLINE Cell<BRACE_VOXEL_UINT8> near_cell<BRACE_VOXEL_UINT8>(const PackedVolume& volume,
                                                                const Point& voxel, const Box& box) {
  const NearTiles tiles = near_tiles(volume, box);
  const Point at = from_apron(voxel);
  const __m512i x = hn::Sub(to_int(at.x), all_int(tiles.x)).raw,
                y = hn::Sub(to_int(at.y), all_int(tiles.y)).raw;
  const __m512i z = to_int(at.z).raw;
  // Of the two tiles' slices side by side: the column, the row and the tile.
  const __m512i three = _mm512_set1_epi32(3);
  const __m512i in_tile =
      _mm512_or_si512(_mm512_and_si512(x, three), _mm512_slli_epi32(_mm512_and_si512(y, three), 2));
  const __m512i place = _mm512_or_si512(in_tile, _mm512_slli_epi32(_mm512_andnot_si512(three, x), 2));
  const __mmask16 is_lower = _mm512_test_epi32_mask(y, _mm512_set1_epi32(4));
  __m512i near = _mm512_setzero_si512(), far = near;
  __mmask16 before = 0;
  const std::uint32_t* slice = tiles.texels;
  for (std::int32_t k = tiles.first; k <= tiles.last + 1; ++k, slice += PackedVolume::tile_slice_texels) {
    const auto row = [&](const std::uint32_t* from) {
      return _mm512_permutex2var_epi32(_mm512_load_si512(from), place, _mm512_load_si512(from + tiles.right));
    };
    __m512i texels = row(slice);
    if (tiles.lower != 0) texels = _mm512_mask_mov_epi32(texels, is_lower, row(slice + tiles.lower));
    const __mmask16 here = _mm512_cmpeq_epi32_mask(z, _mm512_set1_epi32(k));
    near = _mm512_mask_mov_epi32(near, here, texels);
    far = _mm512_mask_mov_epi32(far, before, texels);
    before = here;
  }
  return {at, Word{near}, Word{far}};
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
