// Level of detail (Weiler et al. 2000): the farther from the eye, the coarser the level of the volume that is sampled
// and the longer the step, so that a voxel of the level is at most as wide as the distance between neighbouring rays
// there, times 2^lod_bias. A step of level l is 2^l smallest steps long; the optical depth of a sample grows with it,
// which is the exact correction of its opacity.
//
// Steps lie on a lattice of the smallest ones, those of level l at multiples of 2^l. Along a ray, which runs away from
// the eye, levels never fall; so a multiple of 2^m, m the level wanted there, begins a step, however it is reached, and
// leaping over transparent samples changes no bit of the others. A coarse voxel is the mean of voxels up to 2 of its
// own edges away: leaps keep that distance from what is visible (brace_skip_margin).
#include "brace/levels.glsl"

struct LodRay {
  float begin;  // units from the eye to the ray's entry
  float pitch;  // a voxel may be as wide as that at a unit's distance
};

LodRay lod_ray(BraceRay ray) {
  const vec3 view = normalize(ray.direction / brace_eye.voxels_per_unit.xyz);
  const float ahead = abs(dot(view, normalize(cross(brace_eye.ray_dx.xyz, brace_eye.ray_dy.xyz))));
  const float pixel = max(length(brace_eye.ray_dx.xyz), length(brace_eye.ray_dy.xyz));
  return LodRay(length((ray.entry - brace_eye.eye.xyz) / brace_eye.voxels_per_unit.xyz),
                ahead * pixel * exp2(cast_lod_bias + ray.level));
}

// Edge of a voxel wanted at the begin of smallest step i, in units.
float lod_width(LodRay lod, int i) { return (lod.begin + float(i) * cast_step_voxels) * lod.pitch; }

// floor(log2(width)) from the float's exponent: never falls as the width grows, which logarithms do not promise.
int lod_wanted(LodRay lod, int i) {
  return clamp((floatBitsToInt(lod_width(lod, i)) >> 23) - 127, 0, brace_level_last());
}

int lod_level(LodRay lod, int i) {
  const int wanted = lod_wanted(lod, i);
  return i == 0 ? wanted : min(wanted, findLSB(i));
}

struct LodSample {
  float part;  // length in smallest steps
  float t;     // units from the entry
  vec3 voxel;
};

LodSample lod_sample(BraceRay ray, float segments, int i, int level) {
  LodSample at;
  at.part = min(segments - float(i), float(1 << level));
  at.t = (float(i) + 0.5 * at.part) * cast_step_voxels;
  at.voxel = ray.entry + at.t * ray.direction;
  return at;
}

#if defined(BRACE_CAST_LOD_MIP_LINEAR)
// Between the level and the next one, by how far the width wanted is on the way from one's to the other's.
float lod_blend(LodRay lod, int i, int level, float value, vec3 voxel) {
  const float place = clamp(lod_width(lod, i) / float(1 << level) - 1.0, 0.0, 1.0);
  if (level >= brace_level_last() || place <= 0.0) return value;
  return value + place * (brace_level_value(voxel, level + 1) - value);
}
#define LOD_SAMPLES(lod, i, level) ((level) < brace_level_last() && lod_width(lod, i) > float(1 << (level)) ? 2u : 1u)
#else
#define lod_blend(lod, i, level, value, voxel) (value)
#define LOD_SAMPLES(lod, i, level) 1u
#endif

// From transparent step i on: the begin of the next step that may be visible.
#if defined(BRACE_SKIP)
int lod_next(BraceRay ray, LodRay lod, int i, int level, vec3 voxel) {
  const int reached = i + brace_skip(ray, voxel, i, cast_step_voxels);
  const int wanted = lod_wanted(lod, reached);
  return max(reached >> wanted << wanted, i + (1 << level));
}
#define LOD_NEXT(i, level, voxel) (i) = lod_next(ray, lod, i, level, voxel); BRACE_COUNT(skip_steps, 1u)
#else
#define LOD_NEXT(i, level, voxel) (i) += 1 << (level)
#endif

void brace_cast(BraceRay ray, inout BraceResult result) {
  BRACE_COUNTERS_DECLARE
  const float segments = ray.extent / cast_step_voxels;
  const int count = int(ceil(segments));
  const LodRay lod = lod_ray(ray);
  const int coarsest = lod_wanted(lod, count);
#if defined(BRACE_CAST_LOD_MIP_LINEAR)
  const int smears = min(coarsest + 1, brace_level_last());
#else
  const int smears = coarsest;
#endif
  const float margin_voxels = smears > 0 ? 2.0 * float(1 << smears) : 0.0;
#if defined(BRACE_SKIP) && defined(BRACE_SKIP_MARGIN)
  brace_skip_margin = margin_voxels;
#endif
  float depth = 0.0;  // optical, in powers of two
  float transmittance = 1.0;
  vec3 colour = vec3(0.0);
  bool opaque = false;
  brace_emit_begin(ray);
  int i = 0;
  BRACE_BEGIN_RAY(ray, i, 0.0, cast_step_voxels, float(1 << coarsest) * cast_step_voxels + margin_voxels);
  i = max(min(i, count) - 1, 0);
  const int begins = lod_wanted(lod, i);
  i = i >> begins << begins;
  // First what is near and sampled from the volume itself, then the coarser levels: a software device runs both sides
  // of a branch in full, but leaves loops.
#define LOD_NEAR
#include "dvr_lod_march.glsl"
#undef LOD_NEAR
#include "dvr_lod_march.glsl"
  brace_emit_end(ray, min(float(i) * cast_step_voxels, ray.extent));
  const float opacity = clamp(1.0 - transmittance, 0.0, 1.0);
  result.colour = vec4(clamp(colour, vec3(0.0), vec3(opacity)), opacity);
  BRACE_COUNTERS_COMMIT;
}
