// Asked after the transparent sample `i` at `voxel`: how many samples to go on, at least 1. What is leapt over must
// be transparent, so that the picture stays the same bit for bit; `step` is the distance of samples in units.
#include "brace/ray.glsl"
#include "brace/volume.glsl"

#define BRACE_SKIP

int brace_skip(BraceRay ray, vec3 voxel, int i, float step) {
  int leap = 1;
  for (int ahead = 0; ahead < skip_look_ahead; ++ahead) {
    const vec3 next = voxel + float(leap) * step * ray.direction;
    const bool is_inside = all(greaterThanEqual(next, vec3(0.0))) && all(lessThanEqual(next, brace_eye.volume_dims.xyz));
    if (!is_inside || !brace_is_empty(brace_fetch(next))) break;
    leap += 1;
  }
  return leap;
}
