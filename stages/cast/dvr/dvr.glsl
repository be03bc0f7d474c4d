// Emission and absorption: T' = -kappa T, C' = kappa c T. The integrator is composed in: here the exponential
// rules of one sample per segment (midpoint, left), beside it the rules of both ends and of adaptive steps.
//
// Exponential midpoint rule: a segment of optical depth x takes the transmittance from T to T exp(-x) and adds c (T - T exp(-x)). The optical depth is
// summed and T taken from the sum, so nothing stalls, and the colours added sum up to no more than 1 - T.
//
// Samples lie on the lattice t_i = (i + 1/2) step from the ray's entry, recomputed from the integer i: leaping
// over transparent samples changes no bit of the others. The last segment is cut at the exit; its sample is
// its own midpoint and its optical depth is scaled by its length. The left rule has t_i = i step.
#extension GL_KHR_shader_subgroup_vote : require

#include "brace/shade.glsl"
#include "brace/transfer_function.glsl"
#include "brace/volume.glsl"

#if defined(BRACE_VOLUME_LEVELS)
#include "dvr_lod.glsl"
#elif defined(BRACE_CAST_TOLERANCE_ON)
#include "dvr_adaptive.glsl"
#elif defined(BRACE_CAST_INTEGRATOR_LINEAR_SOURCE) || defined(BRACE_CAST_INTEGRATOR_PRE_INTEGRATED)
#include "dvr_segments.glsl"
#else

#if defined(BRACE_CAST_INTEGRATOR_LEFT)
#define DVR_PLACE 0.0  // of the sample in its segment
#else
#define DVR_PLACE 0.5
#endif

struct DvrSample {
  float part;  // of a full step; below 1 for the last one
  float t;     // units from the entry
  vec3 voxel;
  BraceCell cell;
};

DvrSample dvr_sample(BraceRay ray, float segments, int i) {
  DvrSample at;
  at.part = min(segments - float(i), 1.0);
  at.t = (float(i) + DVR_PLACE * at.part) * cast_step_voxels;
  at.voxel = ray.entry + at.t * ray.direction;
  at.cell = brace_fetch(at.voxel);
  return at;
}

void brace_cast(BraceRay ray, inout BraceResult result) {
  BRACE_COUNTERS_DECLARE
  const float segments = ray.extent / cast_step_voxels;
  const int count = int(ceil(segments));
  float depth = 0.0;  // optical, in powers of two
  float transmittance = 1.0;
  vec3 colour = vec3(0.0);
  brace_emit_begin(ray);
  int i = 0;
  BRACE_BEGIN_RAY(ray, i, DVR_PLACE, cast_step_voxels, cast_step_voxels);
  while (i < count) {
    // While nothing is visible to any ray of the subgroup: a software device runs masked branches in full, but
    // leaves a loop early. The sample is fetched again after it, which costs less than keeping it in the loop.
    while (i < count) {
      const DvrSample ahead = dvr_sample(ray, segments, i);
      if (!subgroupAll(brace_is_empty(ahead.cell))) break;
      BRACE_COUNT_VISIT;
      BRACE_NEXT_SAMPLE(ray, ahead.voxel, i, cast_step_voxels);
    }
    if (i >= count) break;
    const DvrSample here = dvr_sample(ray, segments, i);
    BRACE_COUNT_VISIT;
    const float coordinate = brace_transfer_coordinate(brace_value(here.cell));
    const vec4 shown = brace_transfer(coordinate);
    const float x = here.part * shown.w;
    if (x > 0.0) {
      result.depth = min(result.depth, here.t);
      const vec3 sample_colour = brace_shade(ray, here.voxel, shown.rgb);
      BRACE_COUNT(shading_fetches, BRACE_SHADE_FETCHES);
      brace_emit_segment(ray, float(i) * cast_step_voxels, (float(i) + here.part) * cast_step_voxels, sample_colour, x);
      depth += x;
      const float left = exp2(-depth);
      colour += (transmittance - left) * sample_colour;
      transmittance = left;
      i += 1;
      if (cast_termination_opacity < 1.0 && transmittance <= 1.0 - cast_termination_opacity) break;
    } else {
      BRACE_NEXT_SAMPLE(ray, here.voxel, i, cast_step_voxels);
    }
  }
  brace_emit_end(ray, min(float(i) * cast_step_voxels, ray.extent));
  const float opacity = clamp(1.0 - transmittance, 0.0, 1.0);
  result.colour = vec4(clamp(colour, vec3(0.0), vec3(opacity)), opacity);
  BRACE_COUNT_VISITED(i);
  BRACE_COUNTERS_COMMIT;
}

#endif
