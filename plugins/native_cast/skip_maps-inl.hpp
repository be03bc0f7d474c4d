// How far a ray may go at once, by any of the skip maps.
// Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_SKIP_MAPS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_SKIP_MAPS_INL
#undef NATIVE_CAST_SKIP_MAPS_INL
#else
#define NATIVE_CAST_SKIP_MAPS_INL
#endif

#include <hwy/highway.h>

#include "lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

/// Of the rays' directions, 1 for those that are parallel to an axis' faces.
struct Inverse {
  Point direction;
  Mask still_x, still_y, still_z;
};

HWY_INLINE Inverse inverse_of(const Packet& rays) {
  const auto is_still = [](Float along) { return hn::Lt(hn::Abs(along), all(1e-20f)); };
  const auto inverse = [](Float along, Mask still) {
    return hn::Div(all(1.0f), hn::IfThenElse(still, all(1.0f), along));
  };
  const Point& to = rays.direction;
  const Mask x = is_still(to.x), y = is_still(to.y), z = is_still(to.z);
  return {{inverse(to.x, x), inverse(to.y, y), inverse(to.z, z)}, x, y, z};
}

/// Steps to the first lattice point beyond the cube [low, high] of voxels, at least 1: brace_skip_leap.
HWY_INLINE Int leap(const Scene& scene, const Packet& rays, const Inverse& inverse, const Point& voxel,
                    const Point& low, const Point& high) {
  const Float zero = hn::Zero(Floats()), never = all(1e9f);
  const auto away = [&](Float at, Float direction, Float slope, Mask still, Float below, Float above) {
    const Float face = hn::IfThenElse(hn::Gt(direction, zero), above, below);
    return hn::IfThenElse(still, never, hn::Mul(hn::Sub(face, at), slope));
  };
  const Float x = away(voxel.x, rays.direction.x, inverse.direction.x, inverse.still_x, low.x, high.x);
  const Float y = away(voxel.y, rays.direction.y, inverse.direction.y, inverse.still_y, low.y, high.y);
  const Float z = away(voxel.z, rays.direction.z, inverse.direction.z, inverse.still_z, low.z, high.z);
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
HWY_INLINE Ahead by_distance(const Scene& scene, const Packet& rays, const Inverse& inverse,
                             const Point& voxel, const Block& block, Int distance) {
  const Float edge = all(scene.skip.edge[0]);
  const Int outer = hn::Max(distance, all_int(1));
  const Int inner = hn::Sub(all_int(1), outer);
  const auto face = [&](Int at, Int by) { return hn::Mul(to_float(hn::Add(at, by)), edge); };
  return {
      leap(scene, rays, inverse, voxel, {face(block.x, inner), face(block.y, inner), face(block.z, inner)},
           {face(block.x, outer), face(block.y, outer), face(block.z, outer)}),
      hn::Eq(distance, all_int(0))};
}

HWY_INLINE Ahead ask_distances(const Scene& scene, const Packet& rays, const Inverse& inverse,
                               const Point& voxel, Mask wanted) {
  const Block block = block_of(scene, voxel, wanted);
  const Word word = gather(scene.skip_words, word_of(block, scene.skip.map, hn::ShiftRight<2>(block.x)));
  const Int shift = hn::ShiftLeft<3>(hn::And(block.x, all_int(3)));
  const Word byte = hn::And(hn::Shr(word, hn::BitCast(Words(), shift)), hn::Set(Words(), 255u));
  return by_distance(scene, rays, inverse, voxel, block, hn::BitCast(Ints(), byte));
}

HWY_INLINE Ahead ask_bits(const Scene& scene, const Packet& rays, const Inverse& inverse, const Point& voxel,
                          Mask wanted) {
  const Block block = block_of(scene, voxel, wanted);
  const Word word = gather(scene.skip_words, word_of(block, scene.skip.plane, hn::ShiftRight<5>(block.x)));
  const Int shift = hn::And(block.x, all_int(31));
  const Word bit = hn::And(hn::Shr(word, hn::BitCast(Words(), shift)), hn::Set(Words(), 1u));
  return by_distance(scene, rays, inverse, voxel, block, hn::Sub(all_int(1), hn::BitCast(Ints(), bit)));
}

/// The largest empty node around each lane's sample, level by level.
HWY_INLINE Ahead ask_octree(const Scene& scene, const Packet& rays, const Inverse& inverse,
                            const Point& voxel, Mask wanted) {
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
  return {leap(scene, rays, inverse, voxel, low,
               {hn::Add(low.x, size), hn::Add(low.y, size), hn::Add(low.z, size)}),
          occupied};
}

HWY_INLINE Ahead ask_skip_map(const Scene& scene, const Packet& rays, const Inverse& inverse,
                              const Point& voxel, Mask wanted) {
  if (scene.skip_map == BRACE_SKIP_MAP_BITS) return ask_bits(scene, rays, inverse, voxel, wanted);
  if (scene.skip_map == BRACE_SKIP_MAP_OCTREE) return ask_octree(scene, rays, inverse, voxel, wanted);
  return ask_distances(scene, rays, inverse, voxel, wanted);
}

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
