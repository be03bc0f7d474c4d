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
constexpr bool has_near_cells = (type == BRACE_VOXEL_UINT8) && (HWY_TARGET == HWY_AVX3);

/// The widest box of points whose cells lie in two tiles and five slices at most.
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
  const auto both = [](const std::int32_t(&of)[4]) {
    return _mm256_broadcastsi128_si256(_mm_load_si128(reinterpret_cast<const __m128i*>(of)));
  };
  const __m256i at = _mm256_cvttps_epi32(_mm256_add_ps(_mm256_load_ps(box.corner), _mm256_set1_ps(0.5f)));
  const __m256i cell = _mm256_max_epi32(_mm256_min_epi32(at, both(volume.last_cell)), _mm256_setzero_si256());
  const __m256i tile = _mm256_srlv_epi32(cell, _mm256_setr_epi32(2, 2, 0, 0, 2, 2, 0, 0));
  alignas(32) std::int32_t cells[8], texels[8];
  _mm256_store_si256(reinterpret_cast<__m256i*>(cells), cell);
  _mm256_store_si256(reinterpret_cast<__m256i*>(texels), _mm256_mullo_epi32(tile, both(volume.pitch)));
  return {volume.texels.data() + texels[0] + texels[1] + texels[2],
          texels[4] - texels[0],
          texels[5] - texels[1],
          cells[0] & ~3,
          cells[1] & ~3,
          cells[2],
          cells[6]};
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
  const __m512i in_box = _mm512_sub_epi32(z, _mm512_set1_epi32(tiles.first));
  const auto slice = [&](int k) {
    const std::uint32_t* const from = tiles.texels + k * PackedVolume::tile_slice_texels;
    const auto row = [&](const std::uint32_t* texels) {
      return _mm512_permutex2var_epi32(_mm512_load_si512(texels), place,
                                       _mm512_load_si512(texels + tiles.right));
    };
    if (tiles.lower == 0) return row(from);
    return _mm512_mask_mov_epi32(row(from), is_lower, row(from + tiles.lower));
  };
  // The first two slices serve the cells of the first; with each more, those of the one before it.
  __m512i near = slice(0), far = slice(1), next = far;
  const std::int32_t more = tiles.last - tiles.first;
  const auto take = [&](int k) {
    const __mmask16 here = _mm512_cmpeq_epi32_mask(in_box, _mm512_set1_epi32(k));
    near = _mm512_mask_mov_epi32(near, here, next);
    next = slice(k + 1);
    far = _mm512_mask_mov_epi32(far, here, next);
  };
  if (more >= 1) take(1);
  if (more >= 2) take(2);
  if (more >= 3) take(3);
  if (more >= 4) take(4);
  return {at, Word{near}, Word{far}};
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
