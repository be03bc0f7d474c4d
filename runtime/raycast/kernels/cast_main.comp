#version 460
// Ray traversal: rays in, colour and first-hit depth out. The cast stage gives
//   void brace_cast(BraceRay ray, inout BraceResult result)
// and finds `result` fully transparent. The skip and stereo stages hook into it, and warps that ask
// for layers.
#define BRACE_KERNEL_CAST
#include "brace/ray_buffers.glsl"
#include "brace/counters.glsl"
#include "stage/parameters.glsl"
#include "stage/skip.glsl"
#include "stage/stereo.glsl"
#include "stage/warp.glsl"
#include "brace/skip.glsl"
#include "brace/emit.glsl"
#include "stage/cast.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, brace_area.size))) return;
  const uint index = brace_ray_index(brace_area.origin + gl_GlobalInvocationID.xy);
  const BraceRay ray = brace_load_ray(index);
  BraceResult result = BraceResult(vec4(0.0), BRACE_NO_HIT);
  if (ray.extent > 0.0) {
    brace_cast(ray, result);
#if defined(BRACE_RAY_HEAT)
    const float heat = min(log2(1.0 + float(brace_ray_heat)) / 10.0, 1.0);
    result.colour = vec4(vec3((1.0 + 254.0 * heat) / 255.0), 1.0);
#endif
  } else {
    brace_emit_nothing();
  }
  brace_result_colours[index] = result.colour;
  brace_result_depths_m[index] = brace_distance_m(ray, result.depth);
}
