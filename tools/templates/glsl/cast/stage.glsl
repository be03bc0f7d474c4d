// Colour and first-hit depth of one ray. `result` comes in fully transparent. The rules: 0 <= r, g, b <= a <= 1,
// colours premultiplied; the depth is the distance from ray.entry to the first visible sample, in units (one unit
// is the smallest voxel spacing), and stays as it is where nothing is visible.
#include "brace/transfer_function.glsl"
#include "brace/volume.glsl"

void brace_cast(BraceRay ray, inout BraceResult result) {
  BRACE_COUNTERS_DECLARE
  float depth = 0.0;  // optical, in powers of two: what is behind it shines through by exp2(-depth)
  vec3 colour = vec3(0.0);
  const int count = int(ceil(ray.extent / cast_step_voxels));
  for (int i = 0; i < count; ++i) {
    // The last step is cut at the exit; a sample lies in the middle of its step.
    const float part = min(ray.extent / cast_step_voxels - float(i), 1.0);
    const float t = (float(i) + 0.5 * part) * cast_step_voxels;
    const float value = brace_value(brace_fetch(ray.entry + t * ray.direction));
    BRACE_COUNT(samples, 1u);

    const float coordinate = brace_transfer_coordinate(value);
    const float absorbed = cast_density * part * brace_optical_depth(coordinate);
    if (absorbed > 0.0) {
      result.depth = min(result.depth, t);
      const float before = exp2(-depth);
      depth += absorbed;
      colour += (before - exp2(-depth)) * brace_transfer_colour(coordinate);
      if (depth > 7.0) break;  // less than a hundredth shines through
    }
  }
  const float opacity = clamp(1.0 - exp2(-depth), 0.0, 1.0);
  result.colour = vec4(clamp(colour, vec3(0.0), vec3(opacity)), opacity);
  BRACE_COUNTERS_COMMIT;
}
