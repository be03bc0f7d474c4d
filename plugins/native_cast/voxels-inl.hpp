// What a ray finds at a point: the cell of voxels, its value, colour and emptiness.
// Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_VOXELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_VOXELS_INL
#undef NATIVE_CAST_VOXELS_INL
#else
#define NATIVE_CAST_VOXELS_INL
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

/// Where a point lies in its cell, and the cell's first texel. Lanes outside `wanted` get texel 0.
struct CellAt {
  Float x, y, z;
  Int i, j, texel;
};

HWY_INLINE Int texel_at(const PackedVolume& volume, Int x, Int y, Int z) {
  const Int tile = hn::Add(hn::Mul(hn::ShiftRight<2>(x), all_int(volume.pitch[0])),
                           hn::Mul(hn::ShiftRight<2>(y), all_int(volume.pitch[1])));
  const Int in_slice = hn::Or(hn::And(x, all_int(3)), hn::ShiftLeft<2>(hn::And(y, all_int(3))));
  return hn::Add(tile, hn::Or(hn::ShiftLeft<4>(z), in_slice));
}

/// The apron moves voxel i from centre i + 0.5 to i + 1.
HWY_INLINE Point from_apron(const Point& voxel) {
  const Float half = all(0.5f);
  return {hn::Add(voxel.x, half), hn::Add(voxel.y, half), hn::Add(voxel.z, half)};
}

HWY_INLINE Float fraction(Float at) {
#if HWY_TARGET == HWY_AVX3
  return Float{_mm512_reduce_ps(at.raw, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC)};
#else
  return hn::Sub(at, hn::Floor(at));
#endif
}

HWY_INLINE CellAt cell_at(const PackedVolume& volume, const Point& voxel, Mask wanted) {
  const Point point = from_apron(voxel);
  const Float x = hn::IfThenElseZero(wanted, point.x), y = hn::IfThenElseZero(wanted, point.y),
              z = hn::IfThenElseZero(wanted, point.z);
  const Int i = to_int(x), j = to_int(y), k = to_int(z);
  return {hn::Sub(x, to_float(i)),  hn::Sub(y, to_float(j)), hn::Sub(z, to_float(k)), i, j,
          texel_at(volume, i, j, k)};
}

/// The texel and the one a slice on.
HWY_INLINE WordPair gather_slices(const PackedVolume& volume, Int texel) {
  const std::uint32_t* const near = volume.texels.data();
  return gather_two(near, near + PackedVolume::tile_slice_texels, texel);
}

HWY_INLINE Float byte_of(Word texels, int byte) {
  const Word shifted = hn::ShiftRightSame(texels, 8 * byte);
  return to_float(hn::BitCast(Ints(), byte == 3 ? shifted : hn::And(shifted, hn::Set(Words(), 255u))));
}
HWY_INLINE Float half_of(Word texels, bool high) {
  const Word half = high ? hn::ShiftRight<16>(texels) : hn::And(texels, hn::Set(Words(), 0xffffu));
  return to_float(hn::BitCast(Ints(), half));
}

/// What lies around a point, as in brace/volume.glsl.
template <brace_voxel_type type>
struct Cell;

template <>
struct Cell<BRACE_VOXEL_UINT8> {
  Point at;  // from the first texel on
  Word near, far;

  HWY_INLINE static Cell fetch(const PackedVolume& volume, const Point& voxel, Mask wanted) {
    const CellAt at = cell_at(volume, voxel, wanted);
    const WordPair pair = gather_slices(volume, at.texel);
    return {from_apron(voxel), pair.first, pair.second};
  }
  HWY_INLINE Float value(const Scene&) const {
    const Float x = fraction(at.x), y = fraction(at.y), z = fraction(at.z);
    Float corner[4];
    for (int c = 0; c < 4; ++c)
      corner[c] = lerp(byte_of(near, c), byte_of(far, c), z);
    return lerp(lerp(corner[0], corner[2], y), lerp(corner[1], corner[3], y), x);
  }
};

template <>
struct Cell<BRACE_VOXEL_UINT16> {
  CellAt at;
  Word texels[4];  // (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1)

  HWY_INLINE static Cell fetch(const PackedVolume& volume, const Point& voxel, Mask wanted) {
    const CellAt at = cell_at(volume, voxel, wanted);
    const Int below = hn::Sub(at.texel, texel_at(volume, at.i, at.j, hn::Zero(Ints())));  // of the slice
    const WordPair near = gather_slices(volume, at.texel);
    const WordPair far = gather_slices(
        volume, hn::Add(below, texel_at(volume, at.i, hn::Add(at.j, all_int(1)), hn::Zero(Ints()))));
    return {at, {near.first, far.first, near.second, far.second}};
  }
  HWY_INLINE Float value(const Scene& scene) const {
    Float row[4];
    for (int r = 0; r < 4; ++r)
      row[r] = lerp(half_of(texels[r], false), half_of(texels[r], true), at.x);
    const float offset = scene.volume->type == BRACE_VOXEL_INT16 ? -32768.0f : 0.0f;
    return hn::Add(lerp(lerp(row[0], row[1], at.y), lerp(row[2], row[3], at.y), at.z), all(offset));
  }
};

template <>
struct Cell<BRACE_VOXEL_FLOAT32> {
  CellAt at;
  Float corner[8];  // x fastest, then y, then z

  HWY_INLINE static Cell fetch(const PackedVolume& volume, const Point& voxel, Mask wanted) {
    Cell cell;
    cell.at = cell_at(volume, voxel, wanted);
    const CellAt& at = cell.at;
    const Int below = hn::Sub(at.texel, texel_at(volume, at.i, at.j, hn::Zero(Ints())));  // of the slice
    for (int c = 0; c < 4; ++c) {
      const Int column =
          texel_at(volume, hn::Add(at.i, all_int(c & 1)), hn::Add(at.j, all_int(c >> 1)), hn::Zero(Ints()));
      const WordPair pair = gather_slices(volume, hn::Add(below, column));
      cell.corner[c] = hn::BitCast(Floats(), pair.first);
      cell.corner[4 + c] = hn::BitCast(Floats(), pair.second);
    }
    return cell;
  }
  HWY_INLINE Float value(const Scene&) const {
    Float row[4];
    for (int r = 0; r < 4; ++r)
      row[r] = lerp(corner[2 * r], corner[2 * r + 1], at.x);
    return lerp(lerp(row[0], row[1], at.y), lerp(row[2], row[3], at.y), at.z);
  }
};

HWY_INLINE Float coordinate_of(const Scene& scene, Float value) {
  return hn::MulAdd(value, all(scene.eye.transfer[0]), all(scene.eye.transfer[1]));
}

/// A place in the transfer table; NaN is at its begin.
struct Entry {
  Int index;
  Float place;
};

template <brace_voxel_type type>
HWY_INLINE Entry entry_at(const Scene& scene, Float coordinate) {
  Float above = hn::Max(coordinate, hn::Zero(Floats()));
  if constexpr (type == BRACE_VOXEL_FLOAT32)
    above = hn::IfThenElseZero(hn::Gt(coordinate, hn::Zero(Floats())), coordinate);
  const Float clamped = hn::Min(above, all(scene.eye.transfer[2]));
  const Int index = hn::Min(to_int(clamped), all_int(scene.last_segment));
  return {index, hn::Sub(clamped, to_float(index))};
}

/// Colour, and the optical depth of a full step.
struct Look {
  Point colour;
  Float depth;
};

HWY_INLINE Look look_up(const Scene& scene, const Entry& entry) {
  const QuadPairs segment = gather_quad_pairs(scene.transfer_segments->entry, entry.index);
  const auto column = [&](int c) {
    return hn::MulAdd(entry.place, segment.second.column[c], segment.first.column[c]);
  };
  return {{column(0), column(1), column(2)}, column(3)};
}

/// The 8-bit voxels that are fully transparent: up to `limit` in each byte, or, where `none` is not 0, no
/// voxel at all.
struct EmptyBytes {
  std::uint32_t limit = 0, none = 1;
};

EmptyBytes empty_bytes(const Scene& scene) {
  const auto is_empty = [&](int voxel) {
    return static_cast<float>(voxel) * scene.eye.transfer[0] + scene.eye.transfer[1] <= scene.eye.transfer[3];
  };
  std::uint32_t voxels = 0;
  while (voxels < 256 && is_empty(static_cast<int>(voxels)))
    ++voxels;
  if (voxels == 0) return {};
  return {(voxels - 1) * 0x01010101u, 0};
}

/// 0 where no byte of either word is above the limit's.
HWY_INLINE Word bytes_above(Word near, Word far, Word limit) {
#if HWY_TARGET == HWY_SCALAR
  const auto byte = [](Word of, int i) { return hn::GetLane(of) >> 8 * i & 255u; };
  bool above = false;
  for (int i = 0; i < 4; ++i)
    above = above || std::max(byte(near, i), byte(far, i)) > byte(limit, i);
  return hn::Set(Words(), above ? 1u : 0u);
#else
  const hn::Repartition<std::uint8_t, Words> bytes;
  const auto largest = hn::Max(hn::BitCast(bytes, near), hn::BitCast(bytes, far));
  return hn::BitCast(Words(), hn::SaturatedSub(largest, hn::BitCast(bytes, limit)));
#endif
}

/// Whether the transfer function shows nothing of a cell because all of it is too low.
HWY_INLINE Mask is_empty(const Scene&, const Cell<BRACE_VOXEL_UINT8>& cell, const EmptyBytes& empty) {
  const Word above = bytes_above(cell.near, cell.far, hn::Set(Words(), empty.limit));
  const Word visible = hn::Or(above, hn::Set(Words(), empty.none));
  return hn::RebindMask(Floats(), hn::Eq(visible, hn::Zero(Words())));
}

template <typename AnyCell>
HWY_INLINE Mask is_empty(const Scene& scene, const AnyCell& cell, const EmptyBytes&) {
  return hn::Le(coordinate_of(scene, cell.value(scene)), all(scene.eye.transfer[3]));
}

template <brace_voxel_type type>
HWY_INLINE Float value_at(const Scene& scene, const Point& voxel, Mask wanted) {
  const auto inside = [&](Float at, int axis) {
    return hn::Max(hn::Zero(Floats()), hn::Min(at, all(scene.eye.volume_dims[axis])));
  };
  const Point clamped{inside(voxel.x, 0), inside(voxel.y, 1), inside(voxel.z, 2)};
  return Cell<type>::fetch(*scene.volume, clamped, wanted).value(scene);
}

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
