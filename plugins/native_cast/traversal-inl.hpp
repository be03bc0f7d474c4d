// A packet's way through the volume.
// Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_TRAVERSAL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_TRAVERSAL_INL
#undef NATIVE_CAST_TRAVERSAL_INL
#else
#define NATIVE_CAST_TRAVERSAL_INL
#endif

#include <limits>

#include <hwy/highway.h>

#include "beam-inl.hpp"
#include "lanes-inl.hpp"
#include "near_cells-inl.hpp"
#include "packet-inl.hpp"
#include "shade-inl.hpp"
#include "skip_maps-inl.hpp"
#include "trail-inl.hpp"
#include "voxels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

/// A point of the sampling lattice: brace's dvr_sample.
struct Lattice {
  Float begin;  // steps from the entry
  Float part;   // of a full step; below 1 for the last one
  Float t;      // units from the entry
};

HWY_INLINE Lattice lattice_point(const Scene& scene, Float segments, Float begin) {
  const Float part = hn::Min(hn::Sub(segments, begin), all(1.0f));
  return {begin, part, hn::Mul(hn::MulAdd(all(0.5f), part, begin), all(scene.step_units))};
}

HWY_INLINE Point along(const Packet& rays, Float t) {
  return {hn::MulAdd(t, rays.direction.x, rays.entry.x), hn::MulAdd(t, rays.direction.y, rays.entry.y),
          hn::MulAdd(t, rays.direction.z, rays.entry.z)};
}

/// Rays that go side by side, all at the same step, where that is possible: then one look into the skip map
/// serves all of them, and their voxels lie close to each other. Else each lane leaps for itself.
template <brace_voxel_type type>
class Traversal {
 public:
  /// `trail`: null where nobody asks for segments.
  HWY_INLINE Traversal(const Scene& scene, const Packet& rays, Trail* trail, brace_work_counts& counts)
      : rays_(rays),
        segments_(hn::Mul(rays_.extent, all(1.0f / scene.step_units))),
        count_(hn::Ceil(segments_)),
        active_(hn::Gt(rays_.extent, hn::Zero(Floats()))),
        trail_(trail),
        end_(rays_.extent) {
    if (trail_ != nullptr) trail_->clear();
    const Float zero = hn::Zero(Floats());
    result_ = {{zero, zero, zero}, zero, all(1.0f), all(std::numeric_limits<float>::infinity())};
    counts.rays += hn::CountTrue(Floats(), active_);
  }

  HWY_INLINE void go(const Scene& scene, const EmptyBytes& empty, brace_work_counts& counts) {
    const Beam beam(scene, rays_, active_, segments_);
    if (beam.goes_together(scene)) {
      go_together(scene, beam, empty, counts);
    } else {
      go_apart(scene, empty, counts);
    }
  }

  HWY_INLINE brace_result store(const Scene& scene, const Rays& rays, const PacketRays& packet) const {
    HWY_NAMESPACE::store(scene, rays, packet, rays_, result_);
    if (trail_ == nullptr) return BRACE_OK;
    return trail_->tell(*scene.segments, packet.index, packet.count, rays_.extent, end_);
  }

 private:
  /// What a step meets, before it is looked up in the transfer table.
  struct Met {
    Lattice at;
    Mask shown;  // lanes whose cells may show something
    Entry entry;
  };

  /// All lanes at the same step. The look-up of a step is done after the next one's cells have been asked
  /// for, so that they do not wait for each other.
  HWY_INLINE void go_together(const Scene& scene, const Beam& beam, const EmptyBytes& empty,
                              brace_work_counts& counts) {
    const bool asks = scene.skip_map != BRACE_SKIP_MAP_NONE;
    std::int32_t step = 0, ask_from = 0;
    Met before{};
    before.shown = no_lane();
    const auto stand_at = [&](std::int32_t at) {
      step = at;
      if (step < beam.whole_steps()) return;
      active_ = hn::And(active_, hn::Lt(all(static_cast<float>(step)), count_));
    };
    while (any(active_)) {
      if (asks && step >= ask_from) {
        counts.skip_steps += 1;
        const BeamAhead ahead = beam.ask(scene, step);
        ask_from = ahead.next;
        if (!ahead.occupied) {
          stand_at(ahead.next);
          continue;
        }
      }
      const float begin = static_cast<float>(step);
      Lattice at{all(begin), all(1.0f), all((begin + 0.5f) * scene.step_units)};
      if (step >= beam.whole_steps()) at = lattice_point(scene, segments_, at.begin);
      const Point voxel = along(rays_, at.t);
      Met met = meet(scene, at, cell_of(scene, beam, step, voxel), empty);
      bool shows = any(met.shown);
      if (any(before.shown)) {
        const Seen seen = integrate(scene, before, counts);
        active_ = hn::AndNot(seen.opaque, active_);
        met.shown = hn::AndNot(seen.opaque, met.shown);
        shows = shows && any(seen.visible);
      }
      counts.samples += hn::CountTrue(Floats(), active_);
      if (shows) ask_from = std::max(ask_from, step + 2);
      before = met;
      stand_at(step + 1);
    }
    if (any(before.shown)) (void)integrate(scene, before, counts);
  }

  HWY_INLINE Cell<type> cell_of(const Scene& scene, const Beam& beam, std::int32_t step,
                                const Point& voxel) const {
    if constexpr (has_near_cells<type>) {
      if (beam.width_voxels(step) < near_voxels)
        return near_cell<type>(*scene.volume, voxel, beam.box_at(scene, step));
    }
    return Cell<type>::fetch(*scene.volume, voxel, active_);
  }

  /// Every lane at its own step.
  void go_apart(const Scene& scene, const EmptyBytes& empty, brace_work_counts& counts) {
    const Inverse inverse = inverse_of(rays_);
    Int i = all_int(0);         // on the lattice
    Int ask_from = all_int(0);  // until then the skip map says that something may be visible
    Mask seeking = active_;
    while (any(active_)) {
      const Lattice at = lattice_point(scene, segments_, to_float(i));
      const Point voxel = along(rays_, at.t);
      if (any(seeking)) {
        counts.skip_steps += hn::CountTrue(Floats(), seeking);
        const Ahead ahead = ask_skip_map(scene, rays_, inverse, voxel, seeking);
        const Mask occupied = for_floats(ahead.occupied);
        const Int beyond = hn::Add(i, ahead.steps);
        ask_from = hn::IfThenElse(for_ints(hn::And(seeking, occupied)), beyond, ask_from);
        seeking = hn::AndNot(occupied, seeking);
        i = hn::IfThenElse(for_ints(seeking), beyond, i);
        active_ = hn::And(active_, hn::Lt(to_float(i), count_));
        seeking = hn::And(seeking, active_);
        continue;
      }
      counts.samples += hn::CountTrue(Floats(), active_);
      const Met met = meet(scene, at, Cell<type>::fetch(*scene.volume, voxel, active_), empty);
      Seen seen{met.shown, no_lane()};
      if (any(met.shown)) seen = integrate(scene, met, counts);
      i = hn::Add(i, all_int(1));
      active_ = hn::And(hn::AndNot(seen.opaque, active_), hn::Lt(to_float(i), count_));
      seeking = hn::AndNot(seen.visible, hn::AndNot(for_floats(hn::Lt(i, ask_from)), active_));
    }
  }

  HWY_INLINE Met meet(const Scene& scene, const Lattice& at, const Cell<type>& cell,
                      const EmptyBytes& empty) const {
    Met met{at, hn::AndNot(is_empty(scene, cell, empty), active_), {}};
    if (!any(met.shown)) return met;
    const Float coordinate = coordinate_of(scene, cell.value(scene));
    if constexpr (type == BRACE_VOXEL_FLOAT32)  // no NaN
      met.shown = hn::And(met.shown, hn::Eq(coordinate, coordinate));
    met.entry = entry_at<type>(scene, coordinate);
    return met;
  }

  /// Lanes where a step was visible, and where it has made the ray opaque.
  struct Seen {
    Mask visible, opaque;
  };

  /// Adds what is visible.
  HWY_INLINE Seen integrate(const Scene& scene, const Met& met, brace_work_counts& counts) {
    Look look = look_up(scene, met.entry);
    const Float x = hn::Mul(met.at.part, look.depth);
    const Mask visible = hn::And(met.shown, hn::Gt(x, hn::Zero(Floats())));
    if (!any(visible)) return {visible, visible};
    if (scene.shading.kind != BRACE_SHADING_NONE) {
      look.colour = shaded<type>(scene, rays_, along(rays_, met.at.t), visible,
                                 {look.colour.x, look.colour.y, look.colour.z});
      counts.shading_fetches += shading_fetches_per_sample(scene) * hn::CountTrue(Floats(), visible);
    }
    add_segment(visible, met.at.t, x, look.colour);
    const Mask opaque = hn::And(visible, hn::Le(result_.transmittance, all(scene.opaque_transmittance)));
    if (trail_ != nullptr) leave(scene, met.at, visible, opaque, look.colour, x);
    return {visible, opaque};
  }

  /// Exponential midpoint rule, for the lanes of `visible`.
  HWY_INLINE void add_segment(Mask visible, Float t, Float x, const Point& colour) {
    result_.hit = hn::IfThenElse(visible, hn::Min(result_.hit, t), result_.hit);
    result_.optical_depth = hn::Add(result_.optical_depth, hn::IfThenElseZero(visible, x));
    const Float left = exp2_minus(result_.optical_depth);
    const Float taken = hn::Sub(result_.transmittance, left);
    result_.colour = {hn::MulAdd(taken, colour.x, result_.colour.x),
                      hn::MulAdd(taken, colour.y, result_.colour.y),
                      hn::MulAdd(taken, colour.z, result_.colour.z)};
    result_.transmittance = left;
  }

  HWY_INLINE void leave(const Scene& scene, const Lattice& at, Mask visible, Mask opaque, const Point& colour,
                        Float x) {
    const Float step = all(scene.step_units);
    trail_->add(visible, hn::Mul(at.begin, step), hn::Mul(hn::Add(at.begin, at.part), step), colour, x);
    end_ = hn::IfThenElse(opaque, hn::Mul(hn::Add(at.begin, all(1.0f)), step), end_);
  }

  Packet rays_;
  Float segments_, count_;
  Mask active_;
  Trail* trail_;
  Float end_;  // where rays are ended early, else their length
  Result result_;
};

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
