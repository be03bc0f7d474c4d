// The rules that integrate between samples (linear source, pre-integrated), with fixed steps. Samples lie at
// t_i = i step from the entry, the last one at the exit; each serves two segments and is fetched once.
//
// Skipping: the samples a leap passes lie in one convex part of the volume whose cells hold nothing visible, so
// the values between two of them are not visible either, and their segments add nothing. The segment that
// leads out of it starts at its last sample.
#include "dvr_segment.glsl"

struct DvrPoint {
  float t;  // units from the entry
  vec3 voxel;
  BraceCell cell;
};

DvrPoint dvr_point(BraceRay ray, float segments, int i) {
  DvrPoint at;
  at.t = min(float(i), segments) * cast_step_voxels;
  at.voxel = ray.entry + at.t * ray.direction;
  at.cell = brace_fetch(at.voxel);
  return at;
}

float dvr_coordinate(DvrPoint at) { return brace_transfer_coordinate(brace_value(at.cell)); }

void brace_cast(BraceRay ray, inout BraceResult result) {
  BRACE_COUNTERS_DECLARE
  const float segments = ray.extent / cast_step_voxels;
  const int count = int(ceil(segments));
  float depth = 0.0;  // optical, in powers of two
  float transmittance = 1.0;
  vec3 colour = vec3(0.0);
  brace_emit_begin(ray);
  BRACE_COUNT_VISIT;
  int i = 0;
  BRACE_BEGIN_RAY(ray, i, 0.0, cast_step_voxels, cast_step_voxels);
  i = clamp(i - 1, 0, count);  // the last sample of what is empty
  DvrEnd front = dvr_end(dvr_coordinate(dvr_point(ray, segments, i)));
  while (i < count) {
    const DvrPoint here = dvr_point(ray, segments, i + 1);
    BRACE_COUNT_VISIT;
    const DvrEnd back = dvr_end(dvr_coordinate(here));
    const float part = min(segments - float(i), 1.0);
    const float full = dvr_segment_depth(front, back);
    const float x = part * full;
    if (x > 0.0) {
      const float begin = float(i) * cast_step_voxels;
      const float middle = 0.5 * (begin + here.t);
      result.depth = min(result.depth, middle);
      const vec3 segment_colour =
          brace_shade(ray, ray.entry + middle * ray.direction, dvr_segment_colour(front, back, x));
      BRACE_COUNT(shading_fetches, BRACE_SHADE_FETCHES);
      brace_emit_segment(ray, begin, here.t, segment_colour, x);
      depth += x;
      const float left = exp2(-depth);
      colour += (transmittance - left) * segment_colour;
      transmittance = left;
      front = back;
      i += 1;
      if (cast_termination_opacity < 1.0 && transmittance <= 1.0 - cast_termination_opacity) break;
    } else {
      // Asked at the back sample, which is the front of the next segment.
      const int before = i;
      BRACE_NEXT_SAMPLE(ray, here.voxel, i, cast_step_voxels);
      front = back;
      if (i > before + 1 && i < count) {
        BRACE_COUNT_VISIT;
        front = dvr_end(dvr_coordinate(dvr_point(ray, segments, i)));
      }
    }
  }
  brace_emit_end(ray, min(float(i) * cast_step_voxels, ray.extent));
  const float opacity = clamp(1.0 - transmittance, 0.0, 1.0);
  result.colour = vec4(clamp(colour, vec3(0.0), vec3(opacity)), opacity);
  BRACE_COUNT_VISITED(i + 1);
  BRACE_COUNTERS_COMMIT;
}
