// The SIMD ray caster: cast/dvr's kernel with a ray in every lane. Lanes stand at different places of their
// rays; all they share is the loop. The same text is compiled for every instruction set (Google Highway) and
// chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cast_area.cpp"
#include <algorithm>
#include <cmath>
#include <limits>

// clang-format off
#include <hwy/foreach_target.h>  // first: it includes this file again for each instruction set
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

#include <algorithm>
#include <cmath>
#include <limits>

#include <hwy/contrib/math/math-inl.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "caster.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using Float = hn::Vec<Floats>;
using Int = hn::Vec<Ints>;
using Word = hn::Vec<Words>;
using Mask = hn::Mask<Floats>;

constexpr std::size_t lanes_max = HWY_MAX_BYTES / 4;

HWY_INLINE Float all(float value) {
  return hn::Set(Floats(), value);
}
HWY_INLINE Int all_int(std::int32_t value) {
  return hn::Set(Ints(), value);
}
HWY_INLINE Float to_float(Int value) {
  return hn::ConvertTo(Floats(), value);
}
/// Towards zero; what a lane does not need is kept in range by its caller.
HWY_INLINE Int to_int(Float value) {
  return hn::ConvertTo(Ints(), value);
}
HWY_INLINE Mask for_floats(hn::Mask<Ints> mask) {
  return hn::RebindMask(Floats(), mask);
}
HWY_INLINE hn::Mask<Ints> for_ints(Mask mask) {
  return hn::RebindMask(Ints(), mask);
}
HWY_INLINE bool any(Mask mask) {
  return !hn::AllFalse(Floats(), mask);
}
HWY_INLINE Float lerp(Float low, Float high, Float place) {
  return hn::MulAdd(place, hn::Sub(high, low), low);
}
HWY_INLINE Word gather(const std::uint32_t* from, Int at) {
  return hn::GatherIndex(Words(), from, at);
}
HWY_INLINE Float gather(const float* from, Int at) {
  return hn::GatherIndex(Floats(), from, at);
}

struct WordPair {
  Word first, second;
};

/// Four floats from `from` + 4 * at per lane, a vector for each.
struct Quads {
  Float column[4];
};

#if HWY_TARGET != HWY_SCALAR
/// Block b of the vector: the quad of index[4 b].
template <typename D>
HWY_INLINE hn::Vec<D> quads_of(D d, const float* from, const std::int32_t* index) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::LoadU(d, from + 4 * std::ptrdiff_t{*index});
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, quads_of(half, from, index + hn::MaxLanes(half)), quads_of(half, from, index));
  }
}
#endif

HWY_INLINE Quads gather_quads(const float* from, Int at) {
#if HWY_TARGET == HWY_SCALAR
  const float* quad = from + 4 * hn::GetLane(at);
  return {{all(quad[0]), all(quad[1]), all(quad[2]), all(quad[3])}};
#else
  HWY_ALIGN std::int32_t index[hn::MaxLanes(Floats())];
  hn::Store(at, Ints(), index);
  // Block b of row k is the quad of lane 4 b + k; a transposition within the blocks makes columns of them.
  const auto row = [&](std::size_t k) { return quads_of(Floats(), from, index + k); };
  const hn::Repartition<double, Floats> halves;
  const Float r0 = row(0), r1 = row(1), r2 = row(2), r3 = row(3);
  const auto ab01 = hn::BitCast(halves, hn::InterleaveLower(Floats(), r0, r1));
  const auto cd01 = hn::BitCast(halves, hn::InterleaveUpper(Floats(), r0, r1));
  const auto ab23 = hn::BitCast(halves, hn::InterleaveLower(Floats(), r2, r3));
  const auto cd23 = hn::BitCast(halves, hn::InterleaveUpper(Floats(), r2, r3));
  return {{hn::BitCast(Floats(), hn::InterleaveLower(halves, ab01, ab23)),
           hn::BitCast(Floats(), hn::InterleaveUpper(halves, ab01, ab23)),
           hn::BitCast(Floats(), hn::InterleaveLower(halves, cd01, cd23)),
           hn::BitCast(Floats(), hn::InterleaveUpper(halves, cd01, cd23))}};
#endif
}

struct Point {
  Float x, y, z;
};

/// 2^-x for x >= 0: a polynomial of the fractional part (Taylor, relative error below 1e-7) and the exponent
/// by its bits. 0 from about x = 126 on.
HWY_INLINE Float exp2_minus(Float x) {
  const Float limited = hn::Min(x, all(126.0f));
  const Float whole = hn::Floor(limited);
  const Float f = hn::Mul(hn::Sub(limited, whole), all(-0.6931471805599453f));  // 2^-fraction = e^f
  Float p = all(1.0f / 40320.0f);
  p = hn::MulAdd(p, f, all(1.0f / 5040.0f));
  p = hn::MulAdd(p, f, all(1.0f / 720.0f));
  p = hn::MulAdd(p, f, all(1.0f / 120.0f));
  p = hn::MulAdd(p, f, all(1.0f / 24.0f));
  p = hn::MulAdd(p, f, all(1.0f / 6.0f));
  p = hn::MulAdd(p, f, all(0.5f));
  p = hn::MulAdd(p, f, all(1.0f));
  p = hn::MulAdd(p, f, all(1.0f));
  const Int exponent = hn::ShiftLeft<23>(hn::Sub(all_int(127), to_int(whole)));
  const Float scaled = hn::Mul(p, hn::BitCast(Floats(), exponent));
  return hn::IfThenElse(hn::Lt(x, all(126.0f)), scaled, hn::Zero(Floats()));
}

/// A packet of rays, a lane each.
struct Packet {
  Point entry, direction, inverse_direction;
  hn::Mask<Floats> still_x, still_y, still_z;  // parallel to this axis' faces
  Float extent;
};

// ---- Voxels
// -------------------------------------------------------------------------------------------------

/// Where a point lies in its cell, and the cell's first texel. Lanes outside `wanted` get texel 0.
struct CellAt {
  Float x, y, z;
  Int i, j, texel;
};

HWY_INLINE Int texel_at(const PackedVolume& volume, Int x, Int y, Int z) {
  const Int tile = hn::Add(hn::Mul(hn::ShiftRight<2>(x), all_int(volume.tile_texels)),
                           hn::Mul(hn::ShiftRight<2>(y), all_int(volume.tile_row_texels)));
  const Int in_slice = hn::Or(hn::And(x, all_int(3)), hn::ShiftLeft<2>(hn::And(y, all_int(3))));
  return hn::Add(tile, hn::Or(hn::ShiftLeft<4>(z), in_slice));
}

HWY_INLINE CellAt cell_at(const PackedVolume& volume, const Point& voxel, Mask wanted) {
  // The apron moves voxel i from centre i + 0.5 to i + 1.
  const Float x = hn::IfThenElseZero(wanted, hn::Add(voxel.x, all(0.5f)));
  const Float y = hn::IfThenElseZero(wanted, hn::Add(voxel.y, all(0.5f)));
  const Float z = hn::IfThenElseZero(wanted, hn::Add(voxel.z, all(0.5f)));
  const Int i = to_int(x), j = to_int(y), k = to_int(z);
  return {hn::Sub(x, to_float(i)),  hn::Sub(y, to_float(j)), hn::Sub(z, to_float(k)), i, j,
          texel_at(volume, i, j, k)};
}

/// The texel and the one a slice on.
HWY_INLINE WordPair gather_slices(const PackedVolume& volume, Int texel) {
  return {gather(volume.texels.data(), texel),
          gather(volume.texels.data() + PackedVolume::tile_slice_texels, texel)};
}

HWY_INLINE Float byte_of(Word texels, int byte) {
  const Word shifted = hn::ShiftRightSame(texels, 8 * byte);
  return to_float(hn::BitCast(Ints(), hn::And(shifted, hn::Set(Words(), 255u))));
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
  CellAt at;
  Word near, far;

  HWY_INLINE static Cell fetch(const PackedVolume& volume, const Point& voxel, Mask wanted) {
    const CellAt at = cell_at(volume, voxel, wanted);
    const WordPair pair = gather_slices(volume, at.texel);
    return {at, pair.first, pair.second};
  }
  HWY_INLINE Float value(const Scene&) const {
    Float corner[4];
    for (int c = 0; c < 4; ++c)
      corner[c] = lerp(byte_of(near, c), byte_of(far, c), at.z);
    return lerp(lerp(corner[0], corner[2], at.y), lerp(corner[1], corner[3], at.y), at.x);
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

// ---- Transfer function
// ----------------------------------------------------------------------------------------

HWY_INLINE Float coordinate_of(const Scene& scene, Float value) {
  return hn::MulAdd(value, all(scene.eye.transfer[0]), all(scene.eye.transfer[1]));
}

/// A place in the transfer table; NaN is at its begin.
struct Entry {
  Int index;
  Float place;
};

HWY_INLINE Entry entry_at(const Scene& scene, Float coordinate) {
  const Float last = all(scene.eye.transfer[2]);
  const Float above = hn::IfThenElseZero(hn::Gt(coordinate, hn::Zero(Floats())), coordinate);
  const Float clamped = hn::Min(above, last);
  const Int index = hn::Min(to_int(clamped), to_int(hn::Sub(last, all(1.0f))));
  return {index, hn::Sub(clamped, to_float(index))};
}

/// Colour, and the optical depth of a full step.
struct Look {
  Point colour;
  Float depth;
};

HWY_INLINE Look look_up(const Scene& scene, const Entry& entry) {
  const Quads low = gather_quads(scene.transfer, entry.index);
  const Quads high = gather_quads(scene.transfer + 4, entry.index);
  const auto column = [&](int c) { return lerp(low.column[c], high.column[c], entry.place); };
  return {{column(0), column(1), column(2)}, column(3)};
}

/// What tells whether one of four bytes of a word is above a limit: the sum of its lower seven bits and `add`
/// has its top bit set if these are; `either` says whether the byte's own top bit is enough.
struct EmptyBytes {
  bool possible = false;
  std::uint32_t add = 0, either = 0;
};

/// For the largest 8-bit voxel up to which everything is fully transparent.
EmptyBytes empty_bytes(const Scene& scene) {
  const auto is_empty = [&](int voxel) {
    return static_cast<float>(voxel) * scene.eye.transfer[0] + scene.eye.transfer[1] <= scene.eye.transfer[3];
  };
  std::uint32_t voxels = 0;
  while (voxels < 256 && is_empty(static_cast<int>(voxels)))
    ++voxels;
  if (voxels == 0) return {};
  const std::uint32_t limit = voxels - 1;
  return {true, (127u - (limit & 127u)) * 0x01010101u, limit < 128 ? 0x80808080u : 0u};
}

/// Whether the transfer function shows nothing of a cell because all of it is too low.
HWY_INLINE Mask is_empty(const Scene&, const Cell<BRACE_VOXEL_UINT8>& cell, const EmptyBytes& empty) {
  const auto over = [&](Word texels) {
    const Word sum = hn::Add(hn::And(texels, hn::Set(Words(), 0x7f7f7f7fu)), hn::Set(Words(), empty.add));
    return hn::Or(hn::And(sum, texels), hn::And(hn::Or(sum, texels), hn::Set(Words(), empty.either)));
  };
  const Word above = hn::And(hn::Or(over(cell.near), over(cell.far)), hn::Set(Words(), 0x80808080u));
  const Word nothing = hn::Set(Words(), empty.possible ? 0u : 1u);  // never equal where nothing is empty
  return hn::RebindMask(Floats(), hn::Eq(above, nothing));
}

template <typename AnyCell>
HWY_INLINE Mask is_empty(const Scene& scene, const AnyCell& cell, const EmptyBytes&) {
  return hn::Le(coordinate_of(scene, cell.value(scene)), all(scene.eye.transfer[3]));
}

// ---- Empty-space skipping
// ---------------------------------------------------------------------------------------

/// Steps to the first lattice point beyond the cube [low, high] of voxels, at least 1: brace_skip_leap.
HWY_INLINE Int leap(const Scene& scene, const Packet& rays, const Point& voxel, const Point& low,
                    const Point& high) {
  const Float zero = hn::Zero(Floats()), never = all(1e9f);
  const auto away = [&](Float at, Float direction, Float inverse, Mask still, Float below, Float above) {
    const Float face = hn::IfThenElse(hn::Gt(direction, zero), above, below);
    return hn::IfThenElse(still, never, hn::Mul(hn::Sub(face, at), inverse));
  };
  const Float x = away(voxel.x, rays.direction.x, rays.inverse_direction.x, rays.still_x, low.x, high.x);
  const Float y = away(voxel.y, rays.direction.y, rays.inverse_direction.y, rays.still_y, low.y, high.y);
  const Float z = away(voxel.z, rays.direction.z, rays.inverse_direction.z, rays.still_z, low.z, high.z);
  const Float nearest = hn::Min(x, hn::Min(y, z));
  const Float steps = hn::Min(hn::Mul(nearest, all(1.0f / scene.step_units)), all(1048576.0f));
  return hn::Add(all_int(1), to_int(hn::Max(steps, zero)));
}

struct Block {
  Int x, y, z;
};

HWY_INLINE Block block_of(const Scene& scene, const Point& voxel, Mask wanted) {
  const Float scale = all(scene.skip.edge[1]);
  const auto along = [&](Float at, std::uint32_t count) {
    const Int block = to_int(hn::IfThenElseZero(wanted, hn::Mul(at, scale)));
    return hn::Max(all_int(0), hn::Min(block, all_int(static_cast<std::int32_t>(count) - 1)));
  };
  return {along(voxel.x, scene.skip.blocks[0]), along(voxel.y, scene.skip.blocks[1]),
          along(voxel.z, scene.skip.blocks[2])};
}

HWY_INLINE Int word_of(const Block& block, const std::uint32_t (&pitch)[4], Int x_words) {
  const Int row = hn::Mul(block.y, all_int(static_cast<std::int32_t>(pitch[0])));
  return hn::Add(hn::Add(x_words, row), hn::Mul(block.z, all_int(static_cast<std::int32_t>(pitch[1]))));
}

/// What a skip map says of a sample: nothing is visible in the next `steps` steps, or, where `occupied`,
/// something may be in all of them, so that the map need not be asked before.
struct Ahead {
  Int steps;
  hn::Mask<Ints> occupied;
};

/// From the distance in blocks to the nearest occupied one.
HWY_INLINE Ahead by_distance(const Scene& scene, const Packet& rays, const Point& voxel, const Block& block,
                             Int distance) {
  const Float edge = all(scene.skip.edge[0]);
  const Int outer = hn::Max(distance, all_int(1));
  const Int inner = hn::Sub(all_int(1), outer);
  const auto face = [&](Int at, Int by) { return hn::Mul(to_float(hn::Add(at, by)), edge); };
  return {leap(scene, rays, voxel, {face(block.x, inner), face(block.y, inner), face(block.z, inner)},
               {face(block.x, outer), face(block.y, outer), face(block.z, outer)}),
          hn::Eq(distance, all_int(0))};
}

HWY_INLINE Ahead ask_distances(const Scene& scene, const Packet& rays, const Point& voxel, Mask wanted) {
  const Block block = block_of(scene, voxel, wanted);
  const Word word = gather(scene.skip_words, word_of(block, scene.skip.map, hn::ShiftRight<2>(block.x)));
  const Int shift = hn::ShiftLeft<3>(hn::And(block.x, all_int(3)));
  const Word byte = hn::And(hn::Shr(word, hn::BitCast(Words(), shift)), hn::Set(Words(), 255u));
  return by_distance(scene, rays, voxel, block, hn::BitCast(Ints(), byte));
}

HWY_INLINE Ahead ask_bits(const Scene& scene, const Packet& rays, const Point& voxel, Mask wanted) {
  const Block block = block_of(scene, voxel, wanted);
  const Word word = gather(scene.skip_words, word_of(block, scene.skip.plane, hn::ShiftRight<5>(block.x)));
  const Int shift = hn::And(block.x, all_int(31));
  const Word bit = hn::And(hn::Shr(word, hn::BitCast(Words(), shift)), hn::Set(Words(), 1u));
  return by_distance(scene, rays, voxel, block, hn::Sub(all_int(1), hn::BitCast(Ints(), bit)));
}

/// The largest empty node around each lane's sample, level by level.
HWY_INLINE Ahead ask_octree(const Scene& scene, const Packet& rays, const Point& voxel, Mask wanted) {
  const Block block = block_of(scene, voxel, wanted);
  const auto words = static_cast<std::int32_t>(scene.skip.octree[1]);
  hn::Mask<Ints> rising = for_ints(wanted);  // lanes whose nodes were all empty up to here
  hn::Mask<Ints> occupied = rising;
  Float size = all(scene.skip.edge[0]);  // of the largest empty node, or of the occupied block
  const auto corner = [&](Int at) { return hn::Mul(to_float(at), size); };
  Point low{corner(block.x), corner(block.y), corner(block.z)};
  for (std::uint32_t level = 0; level < scene.skip.octree[0]; ++level) {
    const std::uint32_t(&nodes)[4] = scene.skip.level[level];
    const auto up = [&](Int at) { return hn::ShiftRightSame(at, static_cast<int>(level)); };
    const Int x = up(block.x), y = up(block.y), z = up(block.z);
    const Int row = hn::Add(hn::Mul(z, all_int(static_cast<std::int32_t>(nodes[1]))), y);
    const Int node = hn::Add(hn::Mul(row, all_int(static_cast<std::int32_t>(nodes[0]))), x);
    const Int at = hn::Add(hn::Mul(node, all_int(words)), all_int(static_cast<std::int32_t>(nodes[3])));
    Word shown = hn::Zero(Words());
    for (std::int32_t w = 0; w < words; ++w) {
      const Word visible = hn::Set(Words(), scene.skip.visible[w >> 2][w & 3]);
      shown = hn::Or(shown, hn::And(gather(scene.skip_words + w, at), visible));
    }
    rising = hn::And(rising, hn::RebindMask(Ints(), hn::Eq(shown, hn::Zero(Words()))));
    if (hn::AllFalse(Ints(), rising)) break;
    const Float edge = all(scene.skip.edge[0] * static_cast<float>(1u << level));
    const Mask here = for_floats(rising);
    size = hn::IfThenElse(here, edge, size);
    low = {hn::IfThenElse(here, hn::Mul(to_float(x), edge), low.x),
           hn::IfThenElse(here, hn::Mul(to_float(y), edge), low.y),
           hn::IfThenElse(here, hn::Mul(to_float(z), edge), low.z)};
    occupied = hn::AndNot(rising, occupied);
  }
  return {leap(scene, rays, voxel, low, {hn::Add(low.x, size), hn::Add(low.y, size), hn::Add(low.z, size)}),
          occupied};
}

HWY_INLINE Ahead ask_skip_map(const Scene& scene, const Packet& rays, const Point& voxel, Mask wanted) {
  if (scene.skip_map == BRACE_SKIP_MAP_BITS) return ask_bits(scene, rays, voxel, wanted);
  if (scene.skip_map == BRACE_SKIP_MAP_OCTREE) return ask_octree(scene, rays, voxel, wanted);
  return ask_distances(scene, rays, voxel, wanted);
}

// ---- Shading
// ------------------------------------------------------------------------------------------------------

constexpr std::uint64_t shading_fetches_per_sample = 6;
constexpr float shade_flat = 1e-3f;  // BRACE_SHADE_FLAT

template <brace_voxel_type type>
HWY_INLINE Float value_at(const Scene& scene, const Point& voxel, Mask wanted) {
  const auto inside = [&](Float at, int axis) {
    return hn::Max(hn::Zero(Floats()), hn::Min(at, all(scene.eye.volume_dims[axis])));
  };
  const Point clamped{inside(voxel.x, 0), inside(voxel.y, 1), inside(voxel.z, 2)};
  return Cell<type>::fetch(*scene.volume, clamped, wanted).value(scene);
}

/// Blinn-Phong with the light at the eye, as brace/shade.glsl.
template <brace_voxel_type type>
HWY_NOINLINE void shade(const Scene& scene, const Packet& rays, const Point& at, Mask wanted, Point& colour) {
  const Float one = all(1.0f);
  const auto difference = [&](const Point& high, const Point& low, int axis) {
    const float scale =
        0.5f * scene.eye.voxels_per_unit[axis] * scene.eye.transfer[0] / scene.eye.transfer[2];
    return hn::Mul(hn::Sub(value_at<type>(scene, high, wanted), value_at<type>(scene, low, wanted)),
                   all(scale));
  };
  const Point g{difference({hn::Add(at.x, one), at.y, at.z}, {hn::Sub(at.x, one), at.y, at.z}, 0),
                difference({at.x, hn::Add(at.y, one), at.z}, {at.x, hn::Sub(at.y, one), at.z}, 1),
                difference({at.x, at.y, hn::Add(at.z, one)}, {at.x, at.y, hn::Sub(at.z, one)}, 2)};
  const auto dot = [](const Point& a, const Point& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
  };
  const auto unit = [&](Float along, int axis) {
    return hn::Mul(along, all(1.0f / scene.eye.voxels_per_unit[axis]));
  };
  const Point view{unit(rays.direction.x, 0), unit(rays.direction.y, 1), unit(rays.direction.z, 2)};
  const Float flat = all(shade_flat);
  const Float size = hn::Sqrt(dot(g, g));
  const Float facing = hn::Min(hn::Div(hn::Add(hn::Abs(dot(g, view)), flat), hn::Add(size, flat)), one);
  const Float power = hn::Exp(Floats(), hn::Mul(all(scene.shading.shininess), hn::Log(Floats(), facing)));
  const Float glint =
      hn::Mul(hn::Mul(all(scene.shading.specular), power), hn::Div(size, hn::Add(size, flat)));
  const Float lit = hn::MulAdd(all(scene.shading.diffuse), facing, all(scene.shading.ambient));
  colour = {hn::Min(hn::MulAdd(colour.x, lit, glint), one), hn::Min(hn::MulAdd(colour.y, lit, glint), one),
            hn::Min(hn::MulAdd(colour.z, lit, glint), one)};
}

// ---- Rays
// ---------------------------------------------------------------------------------------------------------

/// The rays of a packet by their index; lanes without one get a ray of length 0.
struct PacketRays {
  std::size_t index[lanes_max];
  std::size_t count = 0;
};

HWY_INLINE Packet load(const Rays& rays, const PacketRays& packet) {
  HWY_ALIGN float columns[8][lanes_max] = {};
  for (std::size_t lane = 0; lane < packet.count; ++lane) {
    const float* entry = rays.entries + 4 * packet.index[lane];
    const float* direction = rays.directions + 4 * packet.index[lane];
    for (std::size_t c = 0; c < 4; ++c) {
      columns[c][lane] = entry[c];
      columns[4 + c][lane] = direction[c];
    }
  }
  const auto column = [&](std::size_t c) { return hn::Load(Floats(), columns[c]); };
  Packet loaded;
  loaded.entry = {column(0), column(1), column(2)};
  loaded.extent = column(3);
  loaded.direction = {column(4), column(5), column(6)};
  const auto is_still = [](Float along) { return hn::Lt(hn::Abs(along), all(1e-20f)); };
  const auto inverse = [](Float along, Mask still) {
    return hn::Div(all(1.0f), hn::IfThenElse(still, all(1.0f), along));
  };
  loaded.still_x = is_still(loaded.direction.x);
  loaded.still_y = is_still(loaded.direction.y);
  loaded.still_z = is_still(loaded.direction.z);
  loaded.inverse_direction = {inverse(loaded.direction.x, loaded.still_x),
                              inverse(loaded.direction.y, loaded.still_y),
                              inverse(loaded.direction.z, loaded.still_z)};
  return loaded;
}

struct Result {
  Point colour;
  Float optical_depth, transmittance, hit;
};

void store(const Scene& scene, const Rays& rays, const PacketRays& packet, const Packet& loaded,
           const Result& result) {
  const auto metric = [&](Float entry, int axis) {
    return hn::Mul(hn::Sub(entry, all(scene.eye.eye[axis])), all(1.0f / scene.eye.voxels_per_unit[axis]));
  };
  const Point to{metric(loaded.entry.x, 0), metric(loaded.entry.y, 1), metric(loaded.entry.z, 2)};
  const Float length = hn::Sqrt(hn::MulAdd(to.x, to.x, hn::MulAdd(to.y, to.y, hn::Mul(to.z, to.z))));
  const Float zero = hn::Zero(Floats());
  const Float opacity = hn::Max(zero, hn::Min(hn::Sub(all(1.0f), result.transmittance), all(1.0f)));
  HWY_ALIGN float out[5][lanes_max] = {};
  const auto put = [&](Float colour, std::size_t c) {
    hn::Store(hn::Min(hn::Max(colour, zero), opacity), Floats(), out[c]);
  };
  put(result.colour.x, 0);
  put(result.colour.y, 1);
  put(result.colour.z, 2);
  put(opacity, 3);
  hn::Store(hn::Mul(hn::Add(length, result.hit), all(scene.eye.eye[3])), Floats(), out[4]);
  for (std::size_t lane = 0; lane < packet.count; ++lane) {
    float* colour = rays.colours + 4 * packet.index[lane];
    for (std::size_t c = 0; c < 4; ++c)
      colour[c] = out[c][lane];
    rays.depths_m[packet.index[lane]] = out[4][lane];
  }
}

/// A point of the sampling lattice: brace's dvr_sample.
struct Lattice {
  Float part;  // of a full step; below 1 for the last one
  Float t;     // units from the entry
};

HWY_INLINE Lattice lattice_point(const Scene& scene, Float segments, Int i) {
  const Float begin = to_float(i);
  const Float part = hn::Min(hn::Sub(segments, begin), all(1.0f));
  return {part, hn::Mul(hn::MulAdd(all(0.5f), part, begin), all(scene.step_units))};
}

HWY_INLINE Point along(const Packet& rays, Float t) {
  return {hn::MulAdd(t, rays.direction.x, rays.entry.x), hn::MulAdd(t, rays.direction.y, rays.entry.y),
          hn::MulAdd(t, rays.direction.z, rays.entry.z)};
}

/// Exponential midpoint rule, for the lanes of `visible`.
HWY_INLINE void add_segment(Mask visible, Float t, Float x, const Point& colour, Result& result) {
  result.hit = hn::IfThenElse(visible, hn::Min(result.hit, t), result.hit);
  result.optical_depth = hn::Add(result.optical_depth, hn::IfThenElseZero(visible, x));
  const Float left = hn::IfThenElse(visible, exp2_minus(result.optical_depth), result.transmittance);
  const Float taken = hn::Sub(result.transmittance, left);
  result.colour = {hn::MulAdd(taken, colour.x, result.colour.x), hn::MulAdd(taken, colour.y, result.colour.y),
                   hn::MulAdd(taken, colour.z, result.colour.z)};
  result.transmittance = left;
}

/// A packet on its way through the volume.
template <brace_voxel_type type>
class Traversal {
 public:
  HWY_INLINE Traversal(const Scene& scene, const Rays& rays, const PacketRays& packet,
                       brace_work_counts& counts)
      : rays_(load(rays, packet)),
        segments_(hn::Mul(rays_.extent, all(1.0f / scene.step_units))),
        count_(hn::Ceil(segments_)),
        i_(all_int(0)),
        ask_from_(all_int(0)),
        active_(hn::Gt(rays_.extent, hn::Zero(Floats()))),
        seeking_(scene.skip_map == BRACE_SKIP_MAP_NONE ? hn::Lt(segments_, segments_) : active_),
        skips_(scene.skip_map != BRACE_SKIP_MAP_NONE) {
    const Float zero = hn::Zero(Floats());
    result_ = {{zero, zero, zero}, zero, all(1.0f), all(std::numeric_limits<float>::infinity())};
    counts.rays += hn::CountTrue(Floats(), active_);
  }

  /// Asks the skip map for the lanes that seek; if there are none, takes a sample. False when nothing is
  /// left.
  HWY_INLINE bool step(const Scene& scene, const EmptyBytes& empty, brace_work_counts& counts) {
    if (!any(active_)) return false;
    if (any(seeking_)) {
      seek(scene, counts);
    } else {
      sample(scene, empty, counts);
    }
    return true;
  }

  void store(const Scene& scene, const Rays& rays, const PacketRays& packet) const {
    HWY_NAMESPACE::store(scene, rays, packet, rays_, result_);
  }

 private:
  HWY_INLINE void seek(const Scene& scene, brace_work_counts& counts) {
    counts.skip_steps += hn::CountTrue(Floats(), seeking_);
    const Point here = along(rays_, lattice_point(scene, segments_, i_).t);
    const Ahead ahead = ask_skip_map(scene, rays_, here, seeking_);
    const Mask occupied = for_floats(ahead.occupied);
    const Int beyond = hn::Add(i_, ahead.steps);
    ask_from_ = hn::IfThenElse(for_ints(hn::And(seeking_, occupied)), beyond, ask_from_);
    seeking_ = hn::AndNot(occupied, seeking_);
    i_ = hn::IfThenElse(for_ints(seeking_), beyond, i_);
    active_ = hn::And(active_, hn::Lt(to_float(i_), count_));
    seeking_ = hn::And(seeking_, active_);
  }

  HWY_INLINE void sample(const Scene& scene, const EmptyBytes& empty, brace_work_counts& counts) {
    const Lattice at = lattice_point(scene, segments_, i_);
    const Point voxel = along(rays_, at.t);
    const auto cell = Cell<type>::fetch(*scene.volume, voxel, active_);
    counts.samples += hn::CountTrue(Floats(), active_);
    Mask visible = hn::AndNot(is_empty(scene, cell, empty), active_);
    if (any(visible)) visible = integrate(scene, at, voxel, cell, visible, counts);
    i_ = hn::Add(i_, all_int(1));
    active_ = hn::And(active_, hn::Lt(to_float(i_), count_));
    if (skips_) seeking_ = hn::AndNot(visible, hn::AndNot(for_floats(hn::Lt(i_, ask_from_)), active_));
  }

  /// Adds what is visible, and returns where that was.
  HWY_INLINE Mask integrate(const Scene& scene, const Lattice& at, const Point& voxel, const Cell<type>& cell,
                            Mask visible, brace_work_counts& counts) {
    const Float coordinate = coordinate_of(scene, cell.value(scene));
    Look look = look_up(scene, entry_at(scene, coordinate));
    const Float x = hn::Mul(at.part, look.depth);
    visible = hn::And(hn::And(visible, hn::Gt(x, hn::Zero(Floats()))),
                      hn::Eq(coordinate, coordinate));  // NaN is empty
    if (!any(visible)) return visible;
    if (scene.shading.phong) {
      shade<type>(scene, rays_, voxel, visible, look.colour);
      counts.shading_fetches += shading_fetches_per_sample * hn::CountTrue(Floats(), visible);
    }
    add_segment(visible, at.t, x, look.colour, result_);
    active_ =
        hn::AndNot(hn::And(visible, hn::Le(result_.transmittance, all(scene.opaque_transmittance))), active_);
    return visible;
  }

  Packet rays_;
  Float segments_, count_;
  Int i_;         // on the lattice
  Int ask_from_;  // until then the skip map says that something may be visible
  Mask active_;
  Mask seeking_;  // lanes that ask the skip map
  bool skips_;
  Result result_;
};

/// Packets are as square as the lanes allow: 4 x 4, 4 x 2, 2 x 2 or 1. Two of them, one below the other, go
/// at a time: each waits for its own memory.
template <brace_voxel_type type>
void cast_voxels(const Scene& scene, const Rays& rays, const brace_area& area, brace_work_counts& counts) {
  const std::size_t lanes = hn::Lanes(Floats());
  const std::uint32_t wide = lanes >= 8 ? 4 : lanes >= 4 ? 2 : 1;
  const auto high = static_cast<std::uint32_t>(lanes / wide);
  const EmptyBytes empty = empty_bytes(scene);
  const auto packet_at = [&](std::uint32_t x, std::uint32_t y) {
    PacketRays packet;
    for (std::uint32_t row = y; row < std::min(y + high, area.height); ++row) {
      for (std::uint32_t column = x; column < std::min(x + wide, area.width); ++column)
        packet.index[packet.count++] = std::size_t{area.y + row} * rays.across + area.x + column;
    }
    return packet;
  };
  for (std::uint32_t y = 0; y < area.height; y += 2 * high) {
    for (std::uint32_t x = 0; x < area.width; x += wide) {
      const PacketRays upper = packet_at(x, y), lower = packet_at(x, y + high);
      Traversal<type> a(scene, rays, upper, counts), b(scene, rays, lower, counts);
      bool more_a = true, more_b = true;
      while (more_a || more_b) {
        more_a = a.step(scene, empty, counts);
        more_b = b.step(scene, empty, counts);
      }
      a.store(scene, rays, upper);
      b.store(scene, rays, lower);
    }
  }
}

void cast_area_here(const Scene& scene, const Rays& rays, const brace_area& area, brace_work_counts& counts) {
  switch (scene.volume->type) {
    case BRACE_VOXEL_UINT8:
      return cast_voxels<BRACE_VOXEL_UINT8>(scene, rays, area, counts);
    case BRACE_VOXEL_FLOAT32:
      return cast_voxels<BRACE_VOXEL_FLOAT32>(scene, rays, area, counts);
    case BRACE_VOXEL_INT16:
    case BRACE_VOXEL_UINT16:
      return cast_voxels<BRACE_VOXEL_UINT16>(scene, rays, area, counts);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace native_cast {

namespace {

struct InstructionSet {
  const char* name;
  std::int64_t target;
};

// Best first. The last is plain C++, a ray at a time.
constexpr InstructionSet sets[] = {
    {"avx512", HWY_AVX3}, {"avx2", HWY_AVX2}, {"sse4", HWY_SSE4}, {"neon", HWY_NEON}, {"scalar", HWY_SCALAR}};

bool is_there(const InstructionSet& set) {
  hwy::SetSupportedTargetsForTest(0);  // what the processor can
  return set.target == HWY_STATIC_TARGET || (set.target & HWY_TARGETS & hwy::SupportedTargets()) != 0;
}

}  // namespace

HWY_EXPORT(cast_area_here);

void cast_area(const Scene& scene, const Rays& rays, const brace_area& area, brace_work_counts& counts) {
  HWY_DYNAMIC_DISPATCH(cast_area_here)(scene, rays, area, counts);
}

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (const InstructionSet& set : sets) {
    if (is_there(set)) names.emplace_back(set.name);
  }
  return names;
}

void choose_instruction_set(const std::string& name) {
  for (const InstructionSet& set : sets) {
    if ((name != "auto" && name != set.name) || !is_there(set)) continue;
    hwy::SetSupportedTargetsForTest(set.target);
    return;
  }
}

}  // namespace native_cast
#endif
