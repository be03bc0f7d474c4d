// Lighting of visible samples, as brace/shade.glsl.
// Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_SHADE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_SHADE_INL
#undef NATIVE_CAST_SHADE_INL
#else
#define NATIVE_CAST_SHADE_INL
#endif

#include <algorithm>
#include <cmath>

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "glsl/brace/light_directions.h"
#include "lanes-inl.hpp"
#include "voxels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

constexpr float shade_flat = 1e-3f;  // BRACE_SHADE_FLAT

inline std::uint64_t shading_fetches_per_sample(const Scene& scene) {
  switch (scene.shading.kind) {
    case BRACE_SHADING_NONE:
      return 0;
    case BRACE_SHADING_PHONG:
      return 6;
    case BRACE_SHADING_SHADOW_AO:
      return BRACE_SHADOW_SAMPLES + BRACE_OCCLUSION_SAMPLES;
    case BRACE_SHADING_RANDOM_LIGHTS:
      return static_cast<std::uint64_t>(scene.shading.samples);
  }
  return 0;
}

/// Blinn-Phong with the light at the eye, as brace/shade.glsl.
template <brace_voxel_type type>
HWY_NOINLINE Point lit_by_phong(const Scene& scene, const Packet& rays, const Point& at, Mask wanted,
                                Point colour) {
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
  return {hn::Min(hn::MulAdd(colour.x, lit, glint), one), hn::Min(hn::MulAdd(colour.y, lit, glint), one),
          hn::Min(hn::MulAdd(colour.z, lit, glint), one)};
}

/// Optical depth, in powers of two, of `samples` steps from a point in a direction; nothing outside of the
/// volume.
template <brace_voxel_type type>
HWY_NOINLINE Float depth_towards(const Scene& scene, const Point& from, const float (&direction)[3],
                                 int samples, Mask wanted) {
  const Shading& shading = scene.shading;
  const auto stride = [&](int axis) {
    return shading.step_units * direction[axis] * scene.eye.voxels_per_unit[axis];
  };
  const float x = stride(0), y = stride(1), z = stride(2);
  const Float zero = hn::Zero(Floats());
  const auto inside = [&](Float at, int axis) {
    return hn::And(hn::Ge(at, zero), hn::Le(at, all(scene.eye.volume_dims[axis])));
  };
  Float depth = zero;
  for (int i = 1; i <= samples; ++i) {
    const Float steps = all(static_cast<float>(i));
    const Point at{hn::MulAdd(steps, all(x), from.x), hn::MulAdd(steps, all(y), from.y),
                   hn::MulAdd(steps, all(z), from.z)};
    const Mask there = hn::And(hn::And(inside(at.x, 0), inside(at.y, 1)), hn::And(inside(at.z, 2), wanted));
    if (!any(there)) continue;
    const Entry entry = entry_at<type>(scene, coordinate_of(scene, value_at<type>(scene, at, there)));
    const Int segment = hn::ShiftLeft<3>(entry.index);
    const Float here = hn::MulAdd(entry.place, gather(scene.transfer_segments->rise + 3, segment),
                                  gather(scene.transfer_segments->entry + 3, segment));
    depth = hn::Add(depth, hn::IfThenElseZero(hn::And(there, hn::Gt(here, zero)), here));
  }
  return hn::Mul(depth, all(shading.step_units / scene.step_units));
}

HWY_INLINE Point scaled(const Point& colour, Float x, Float y, Float z) {
  return {hn::Mul(colour.x, x), hn::Mul(colour.y, y), hn::Mul(colour.z, z)};
}

template <brace_voxel_type type>
HWY_NOINLINE Point lit_by_shadow_ao(const Scene& scene, const Point& at, Mask wanted, Point colour) {
#define NATIVE_CAST_TRIPLE(x, y, z) \
  { x, y, z }
  constexpr float around[BRACE_OCCLUSION_SAMPLES][3] = {BRACE_OCCLUSION_DIRECTIONS(NATIVE_CAST_TRIPLE)};
  const Float lit =
      exp2_minus(depth_towards<type>(scene, at, scene.shading.light, BRACE_SHADOW_SAMPLES, wanted));
  Float open = hn::Zero(Floats());
  for (const auto& direction : around)
    open = hn::Add(open, exp2_minus(depth_towards<type>(scene, at, direction, 1, wanted)));
  const Float share = hn::Mul(hn::Mul(lit, open), all(1.0f / BRACE_OCCLUSION_SAMPLES));
  return scaled(colour, share, share, share);
}

template <brace_voxel_type type>
HWY_NOINLINE Point lit_by_random_lights(const Scene& scene, const Point& at, Mask wanted, Point colour) {
  constexpr float lights[BRACE_LIGHTS_MAX][3] = {BRACE_LIGHT_DIRECTIONS(NATIVE_CAST_TRIPLE)};
#undef NATIVE_CAST_TRIPLE
  const int samples = scene.shading.samples;
  const int count = std::max((samples + BRACE_SAMPLES_PER_LIGHT - 1) / BRACE_SAMPLES_PER_LIGHT, 1);
  Float sum[3] = {hn::Zero(Floats()), hn::Zero(Floats()), hn::Zero(Floats())};
  for (int i = 0; i < count; ++i) {
    const int towards = std::min(BRACE_SAMPLES_PER_LIGHT, samples - BRACE_SAMPLES_PER_LIGHT * i);
    const Float lit = exp2_minus(depth_towards<type>(scene, at, lights[i], towards, wanted));
    for (int c = 0; c < 3; ++c)
      sum[c] = hn::MulAdd(lit, all(std::abs(lights[i][c]) / static_cast<float>(count)), sum[c]);
  }
  return scaled(colour, sum[0], sum[1], sum[2]);
}

/// The colour of a visible sample in the scene's light.
template <brace_voxel_type type>
HWY_INLINE Point shaded(const Scene& scene, const Packet& rays, const Point& at, Mask wanted,
                        const Point& colour) {
  switch (scene.shading.kind) {
    case BRACE_SHADING_NONE:
      break;
    case BRACE_SHADING_PHONG:
      return lit_by_phong<type>(scene, rays, at, wanted, colour);
    case BRACE_SHADING_SHADOW_AO:
      return lit_by_shadow_ao<type>(scene, at, wanted, colour);
    case BRACE_SHADING_RANDOM_LIGHTS:
      return lit_by_random_lights<type>(scene, at, wanted, colour);
  }
  return colour;
}

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
