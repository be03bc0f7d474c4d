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
// clang-format on

#include "caster.hpp"
#include "lanes-inl.hpp"
#include "shade-inl.hpp"
#include "skip_maps-inl.hpp"
#include "trail-inl.hpp"
#include "voxels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

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
  /// `trail`: null where nobody asks for segments.
  HWY_INLINE Traversal(const Scene& scene, const Rays& rays, const PacketRays& packet, Trail* trail,
                       brace_work_counts& counts)
      : rays_(load(rays, packet)),
        segments_(hn::Mul(rays_.extent, all(1.0f / scene.step_units))),
        count_(hn::Ceil(segments_)),
        i_(all_int(0)),
        ask_from_(all_int(0)),
        active_(hn::Gt(rays_.extent, hn::Zero(Floats()))),
        seeking_(scene.skip_map == BRACE_SKIP_MAP_NONE ? hn::Lt(segments_, segments_) : active_),
        skips_(scene.skip_map != BRACE_SKIP_MAP_NONE),
        trail_(trail),
        end_(rays_.extent) {
    if (trail_ != nullptr) trail_->clear();
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

  brace_result store(const Scene& scene, const Rays& rays, const PacketRays& packet) const {
    HWY_NAMESPACE::store(scene, rays, packet, rays_, result_);
    if (trail_ == nullptr) return BRACE_OK;
    return trail_->tell(*scene.segments, packet.index, packet.count, rays_.extent, end_);
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
    if (scene.shading.kind != BRACE_SHADING_NONE) {
      shade<type>(scene, rays_, voxel, visible, look.colour);
      counts.shading_fetches += shading_fetches_per_sample(scene) * hn::CountTrue(Floats(), visible);
    }
    add_segment(visible, at.t, x, look.colour, result_);
    const Mask opaque = hn::And(visible, hn::Le(result_.transmittance, all(scene.opaque_transmittance)));
    if (trail_ != nullptr) leave(scene, at, visible, opaque, look.colour, x);
    active_ = hn::AndNot(opaque, active_);
    return visible;
  }

  HWY_INLINE void leave(const Scene& scene, const Lattice& at, Mask visible, Mask opaque, const Point& colour,
                        Float x) {
    const Float step = all(scene.step_units), begin = to_float(i_);
    trail_->add(visible, hn::Mul(begin, step), hn::Mul(hn::Add(begin, at.part), step), colour, x);
    end_ = hn::IfThenElse(opaque, hn::Mul(hn::Add(begin, all(1.0f)), step), end_);
  }

  Packet rays_;
  Float segments_, count_;
  Int i_;         // on the lattice
  Int ask_from_;  // until then the skip map says that something may be visible
  Mask active_;
  Mask seeking_;  // lanes that ask the skip map
  bool skips_;
  Trail* trail_;
  Float end_;  // where rays are ended early, else their length
  Result result_;
};

/// Packets are as square as the lanes allow: 4 x 4, 4 x 2, 2 x 2 or 1. Two of them, one below the other, go
/// at a time: each waits for its own memory.
template <brace_voxel_type type>
brace_result cast_voxels(const Scene& scene, const Rays& rays, const brace_area& area,
                         brace_work_counts& counts) {
  const std::size_t lanes = hn::Lanes(Floats());
  const std::uint32_t wide = lanes >= 8 ? 4 : lanes >= 4 ? 2 : 1;
  const auto high = static_cast<std::uint32_t>(lanes / wide);
  const EmptyBytes empty = empty_bytes(scene);
  thread_local Trail trails[2];  // grow to what the longest rays leave
  Trail* const trail_a = scene.segments != nullptr ? &trails[0] : nullptr;
  Trail* const trail_b = scene.segments != nullptr ? &trails[1] : nullptr;
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
      Traversal<type> a(scene, rays, upper, trail_a, counts), b(scene, rays, lower, trail_b, counts);
      bool more_a = true, more_b = true;
      while (more_a || more_b) {
        more_a = a.step(scene, empty, counts);
        more_b = b.step(scene, empty, counts);
      }
      const brace_result told_a = a.store(scene, rays, upper), told_b = b.store(scene, rays, lower);
      if (told_a != BRACE_OK || told_b != BRACE_OK) return told_a != BRACE_OK ? told_a : told_b;
    }
  }
  return BRACE_OK;
}

brace_result cast_area_here(const Scene& scene, const Rays& rays, const brace_area& area,
                            brace_work_counts& counts) {
  switch (scene.volume->type) {
    case BRACE_VOXEL_UINT8:
      return cast_voxels<BRACE_VOXEL_UINT8>(scene, rays, area, counts);
    case BRACE_VOXEL_FLOAT32:
      return cast_voxels<BRACE_VOXEL_FLOAT32>(scene, rays, area, counts);
    case BRACE_VOXEL_INT16:
    case BRACE_VOXEL_UINT16:
      return cast_voxels<BRACE_VOXEL_UINT16>(scene, rays, area, counts);
  }
  return BRACE_UNSUPPORTED;
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

brace_result cast_area(const Scene& scene, const Rays& rays, const brace_area& area,
                       brace_work_counts& counts) {
  return HWY_DYNAMIC_DISPATCH(cast_area_here)(scene, rays, area, counts);
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
