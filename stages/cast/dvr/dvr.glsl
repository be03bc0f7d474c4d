// Emission and absorption by the exponential midpoint rule: T' = -kappa T, C' = kappa c T. A segment of
// optical depth x takes the transmittance from T to T exp(-x) and adds c (T - T exp(-x)). The optical depth is
// summed and T taken from the sum, so nothing stalls, and the colours added sum up to no more than 1 - T.
//
// Samples lie on the lattice t_i = (i + 1/2) step from the ray's entry, recomputed from the integer i: leaping
// over transparent samples changes no bit of the others. The last segment is cut at the exit; its sample is
// its own midpoint and its optical depth is scaled by its length.
#include "brace/shade.glsl"
#include "brace/transfer_function.glsl"
#include "brace/volume.glsl"

void brace_cast(BraceRay ray, inout BraceResult result) {
  BRACE_COUNTERS_DECLARE
  const float segments = ray.extent / cast_step_voxels;
  const int count = int(ceil(segments));
  float depth = 0.0;  // optical, in powers of two
  float transmittance = 1.0;
  vec3 colour = vec3(0.0);
  brace_emit_begin(ray);
  int i = 0;
  while (i < count) {
    const float part = min(segments - float(i), 1.0);
    const float t = (float(i) + 0.5 * part) * cast_step_voxels;
    const vec3 voxel = ray.entry + t * ray.direction;
    const float coordinate = brace_transfer_coordinate(brace_volume_inside(voxel));
    BRACE_COUNT(samples, 1u);
    float x = 0.0;
    if (coordinate > brace_eye.transfer.w) x = part * brace_optical_depth(coordinate);
    if (x > 0.0) {
      result.depth = min(result.depth, t);
      const vec3 sample_colour = brace_shade(ray, voxel, brace_transfer_colour(coordinate));
      BRACE_COUNT(shading_fetches, BRACE_SHADE_FETCHES);
      brace_emit_segment(ray, float(i) * cast_step_voxels, (float(i) + part) * cast_step_voxels, sample_colour, x);
      depth += x;
      const float left = exp2(-depth);
      colour += (transmittance - left) * sample_colour;
      transmittance = left;
      i += 1;
      if (cast_termination_opacity < 1.0 && transmittance <= 1.0 - cast_termination_opacity) break;
    } else {
      BRACE_NEXT_SAMPLE(ray, voxel, i, cast_step_voxels);
    }
  }
  brace_emit_end(ray, min(float(i) * cast_step_voxels, ray.extent));
  const float opacity = clamp(1.0 - transmittance, 0.0, 1.0);
  result.colour = vec4(clamp(colour, vec3(0.0), vec3(opacity)), opacity);
  BRACE_COUNTERS_COMMIT;
}
