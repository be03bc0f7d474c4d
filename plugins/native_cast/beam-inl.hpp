// The rays of a packet as one beam: where all of them are at a step, and how far they may go together.
// Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_BEAM_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_BEAM_INL
#undef NATIVE_CAST_BEAM_INL
#else
#define NATIVE_CAST_BEAM_INL
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <hwy/highway.h>

#include "lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

/// A box of voxel coordinates: x, y, z of its lower corner, padding, and the same of the upper corner.
struct Box {
  alignas(32) float corner[8];
};

/// Blocks of the skip map, from the first to the last along each axis.
struct BlockRange {
  std::int32_t first[3], last[3];
};

/// Calls test(x, y, z) for the blocks of a range until one is true.
template <typename Test>
HWY_INLINE bool any_of(const BlockRange& blocks, const Test& test) {
  for (std::int32_t z = blocks.first[2]; z <= blocks.last[2]; ++z) {
    for (std::int32_t y = blocks.first[1]; y <= blocks.last[1]; ++y) {
      for (std::int32_t x = blocks.first[0]; x <= blocks.last[0]; ++x) {
        if (test(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(z)))
          return true;
      }
    }
  }
  return false;
}

/// All blocks nearer to a range than the least distance in it are empty.
HWY_INLINE bool grow_by_distance(const Scene& scene, BlockRange& blocks) {
  std::uint32_t distance = 255;
  const bool occupied = any_of(blocks, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const std::uint32_t word = scene.skip_words[(x >> 2) + y * scene.skip.map[0] + z * scene.skip.map[1]];
    distance = std::min(distance, word >> (8 * (x & 3)) & 255u);
    return distance == 0;
  });
  for (int axis = 0; axis < 3; ++axis) {
    blocks.first[axis] -= static_cast<std::int32_t>(distance) - 1;
    blocks.last[axis] += static_cast<std::int32_t>(distance) - 1;
  }
  return !occupied;
}

/// As far as all nodes around a range are empty, level by level.
inline bool grow_by_octree(const Scene& scene, BlockRange& blocks) {
  const std::uint32_t words = scene.skip.octree[1];
  BlockRange nodes = blocks;
  for (std::uint32_t level = 0; level < scene.skip.octree[0]; ++level) {
    const std::uint32_t(&along)[4] = scene.skip.level[level];
    const bool occupied = any_of(nodes, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
      const std::uint32_t* const node =
          scene.skip_words + along[3] + ((z * along[1] + y) * along[0] + x) * words;
      std::uint32_t shown = 0;
      for (std::uint32_t w = 0; w < words; ++w)
        shown |= node[w] & scene.skip.visible[w >> 2][w & 3];
      return shown != 0;
    });
    if (occupied) return level > 0;
    for (int axis = 0; axis < 3; ++axis) {
      blocks.first[axis] = nodes.first[axis] << level;
      blocks.last[axis] = ((nodes.last[axis] + 1) << level) - 1;
      nodes.first[axis] >>= 1;
      nodes.last[axis] >>= 1;
    }
  }
  return true;
}

/// Grows a range of blocks as far as the skip map says that nothing is visible. False where something may be.
HWY_INLINE bool grow_empty(const Scene& scene, BlockRange& blocks) {
  if (scene.skip_map == BRACE_SKIP_MAP_DISTANCES) return grow_by_distance(scene, blocks);
  if (scene.skip_map == BRACE_SKIP_MAP_OCTREE) return grow_by_octree(scene, blocks);
  return !any_of(blocks, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const std::uint32_t word = scene.skip_words[(x >> 5) + y * scene.skip.plane[0] + z * scene.skip.plane[1]];
    return (word >> (x & 31) & 1u) != 0;
  });
}

/// Steps, for all rays of a beam: what a skip map says of them.
struct BeamAhead {
  std::int32_t next;  // the first step that may show something, or that has to be asked about
  bool occupied;
};

/// A packet's rays: from the least to the largest of their entries and directions. Rays without a length do
/// not count.
class Beam {
 public:
  HWY_INLINE Beam(const Scene& scene, const Packet& rays, Mask active, Float segments) {
    const Float far = all(std::numeric_limits<float>::max());
    const auto least = [&](Float of) {
      return hn::GetLane(hn::MinOfLanes(Floats(), hn::IfThenElse(active, of, far)));
    };
    const auto largest = [&](Float of) {
      return hn::GetLane(hn::MaxOfLanes(Floats(), hn::IfThenElse(active, of, hn::Neg(far))));
    };
    if (!any(active)) return;
    const Float entry[3] = {rays.entry.x, rays.entry.y, rays.entry.z};
    const Float direction[3] = {rays.direction.x, rays.direction.y, rays.direction.z};
    const float length = largest(rays.extent) + scene.step_units;
    whole_ = static_cast<std::int32_t>(std::min(least(segments), steps_max));
    const float margin = margin_voxels(scene);
    width_ = last_width_ = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      const int low = axis, high = 4 + axis;
      entry_[low] = least(entry[axis]) - margin;
      entry_[high] = largest(entry[axis]) + margin;
      direction_[low] = least(direction[axis]);
      direction_[high] = largest(direction[axis]);
      const float spread = (direction_[high] - direction_[low]) * length;
      const float width = entry_[high] - entry_[low] + spread;
      width_ = std::max(width_, width);
      const float speed = std::max(std::abs(direction_[low]), std::abs(direction_[high]));
      last_width_ = std::max(last_width_, width + 0.5f * scene.step_units * speed);
      if (scene.skip_map == BRACE_SKIP_MAP_NONE) continue;
      moves_out(low, direction_[low] < -1e-12f);
      moves_out(high, direction_[high] > 1e-12f);
    }
  }

  /// Whether the rays are near enough to each other for one look into the skip map.
  bool goes_together(const Scene& scene) const {
    constexpr float blocks_max = 4.0f;  // measured: farther apart it no longer pays
    return scene.skip_map == BRACE_SKIP_MAP_NONE || width_ < blocks_max * scene.skip.edge[0];
  }
  /// No edge of box_at(step) is longer.
  float width_voxels(std::int32_t step) const { return step < whole_ ? width_ : last_width_; }
  /// Steps that no ray is shorter than.
  std::int32_t whole_steps() const { return whole_; }

  /// The points of all rays at a step. Rounding is monotonic: none lies outside by more than the margin.
  HWY_INLINE Box box_at(const Scene& scene, std::int32_t step) const {
    const float begin = static_cast<float>(step);
    const float late = (begin + 0.5f) * scene.step_units, early = begin * scene.step_units;
    Box box;
    for (int c = 0; c < 8; ++c)
      box.corner[c] = entry_[c] + direction_[c] * late;
    if (step < whole_) return box;
    for (int c = 0; c < 4; ++c) {  // the last sample of a ray stands nearer
      box.corner[c] = std::min(box.corner[c], entry_[c] + direction_[c] * early);
      box.corner[4 + c] = std::max(box.corner[4 + c], entry_[4 + c] + direction_[4 + c] * early);
    }
    return box;
  }

  /// What the skip map says from `step` on.
  HWY_INLINE BeamAhead ask(const Scene& scene, std::int32_t step) const {
    const Box box = box_at(scene, step);
    BlockRange blocks;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t end = static_cast<std::int32_t>(scene.skip.blocks[axis]) - 1;
      blocks.first[axis] =
          std::clamp(static_cast<std::int32_t>(box.corner[axis] * scene.skip.edge[1]), 0, end);
      blocks.last[axis] =
          std::clamp(static_cast<std::int32_t>(box.corner[4 + axis] * scene.skip.edge[1]), 0, end);
    }
    if (!grow_empty(scene, blocks)) return {step + occupied_steps, true};
    float leaves = never;
    for (int axis = 0; axis < 3; ++axis) {
      const float below = static_cast<float>(blocks.first[axis]) * scene.skip.edge[0];
      const float above = static_cast<float>(blocks.last[axis] + 1) * scene.skip.edge[0];
      leaves = std::min(leaves, (below - entry_[axis]) * inverse_[axis] + stays_[axis]);
      leaves = std::min(leaves, (above - entry_[4 + axis]) * inverse_[4 + axis] + stays_[4 + axis]);
    }
    const float steps = std::min(leaves * (1.0f / scene.step_units) + 0.5f, steps_max);
    return {std::max(step + 1, static_cast<std::int32_t>(steps)), false};
  }

 private:
  static constexpr float steps_max = 1048576.0f;
  static constexpr float never = 1e9f;
  static constexpr std::int32_t occupied_steps = 2;

  /// What rounding may move a point by, and more.
  static float margin_voxels(const Scene& scene) {
    const float* const dims = scene.eye.volume_dims;
    return std::max(1.0f / 256.0f, std::max({dims[0], dims[1], dims[2]}) * 0x1p-20f);
  }

  /// How a face of the box meets a face before it, if it moves outwards.
  void moves_out(int corner, bool does) {
    inverse_[corner] = does ? 1.0f / direction_[corner] : 0.0f;
    stays_[corner] = does ? 0.0f : never;
  }

  // As in Box: of the least and the largest of all rays.
  alignas(32) float entry_[8] = {}, direction_[8] = {};
  float inverse_[8] = {}, stays_[8] = {};
  float width_ = std::numeric_limits<float>::infinity();
  float last_width_ = std::numeric_limits<float>::infinity();  // from the step on where a ray may end
  std::int32_t whole_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
