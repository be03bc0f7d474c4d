#version 460
// Opening brace: a ray for every cell of the ray grid. The rays stage gives
//   BraceRay brace_open(uvec2 cell)
#define BRACE_KERNEL_OPENING
#include "brace/ray_buffers.glsl"
#include "stage/parameters.glsl"
#include "stage/rays.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, brace_area.size))) return;
  const uvec2 cell = brace_area.origin + gl_GlobalInvocationID.xy;
  brace_store_ray(brace_ray_index(cell), brace_open(cell));
}
