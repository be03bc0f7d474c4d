// Maximum-intensity projection. The picture is opaque where a ray meets anything above the threshold; its
// depth is that of the maximum.
#include "brace/transfer_function.glsl"
#include "brace/volume.glsl"

void brace_cast(BraceRay ray, inout BraceResult result) {
  BRACE_COUNTERS_DECLARE
  const int count = int(ceil(ray.extent / cast_step_voxels));
  float largest = -1.0;
  float at = 0.0;
  for (int i = 0; i < count; ++i) {
    const float t = min((float(i) + 0.5) * cast_step_voxels, ray.extent);
    const float coordinate = brace_transfer_coordinate(brace_value(brace_fetch(ray.entry + t * ray.direction)));
    BRACE_COUNT(samples, 1u);
    if (coordinate > largest) {
      largest = coordinate;
      at = t;
    }
  }
  if (largest > cast_threshold * brace_eye.transfer.z) {
    const float grey = clamp(largest / brace_eye.transfer.z, 0.0, 1.0);
    result.colour = vec4(clamp(brace_transfer_colour(largest) * grey, vec3(0.0), vec3(1.0)), 1.0);
    result.depth = at;
  }
  BRACE_COUNTERS_COMMIT;
}
