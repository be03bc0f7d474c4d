// First-hit isosurface. Samples find the interval in which the value crosses the level, bisection narrows it
// down, a last linear interpolation gives the point. The surface is opaque.
#include "brace/gradient.glsl"
#include "brace/transfer_function.glsl"
#include "brace/volume.glsl"

// Above the level: > 0.
float iso_distance(BraceRay ray, float t) {
  return brace_transfer_coordinate(brace_volume(ray.entry + t * ray.direction)) -
         cast_level * brace_eye.transfer.z;
}

float iso_refine(BraceRay ray, float below, float above, float value_below, float value_above) {
  for (int i = 0; i < cast_refinements; ++i) {
    const float middle = 0.5 * (below + above);
    const float value = iso_distance(ray, middle);
    if (value > 0.0) {
      above = middle;
      value_above = value;
    } else {
      below = middle;
      value_below = value;
    }
  }
  const float rise = value_above - value_below;
  return rise > 0.0 ? mix(below, above, clamp(-value_below / rise, 0.0, 1.0)) : above;
}

void brace_cast(BraceRay ray, inout BraceResult result) {
  BRACE_COUNTERS_DECLARE
  const int count = int(ceil(ray.extent / cast_step_voxels));
  float before = 0.0;
  float value_before = iso_distance(ray, 0.0);
  float found = value_before > 0.0 ? 0.0 : -1.0;
  for (int i = 1; i <= count && found < 0.0; ++i) {
    const float t = min(float(i) * cast_step_voxels, ray.extent);
    const float value = iso_distance(ray, t);
    BRACE_COUNT(samples, 1u);
    if (value > 0.0) found = iso_refine(ray, before, t, value_before, value);
    before = t;
    value_before = value;
  }
  if (found >= 0.0) {
    const vec3 voxel = ray.entry + found * ray.direction;
    const vec3 gradient = brace_gradient(voxel);
    BRACE_COUNT(shading_fetches, BRACE_GRADIENT_FETCHES);
    const vec3 view = ray.direction / brace_eye.voxels_per_unit.xyz;  // unit vector
    const float size = length(gradient);
    const float facing = size > 0.0 ? min(abs(dot(gradient, view)) / size, 1.0) : 1.0;
    const vec3 colour = brace_transfer_colour(cast_level * brace_eye.transfer.z);
    result.colour = vec4(clamp(colour * (cast_ambient + (1.0 - cast_ambient) * facing), vec3(0.0), vec3(1.0)), 1.0);
    result.depth = found;
  }
  BRACE_COUNTERS_COMMIT;
}
