// skip/block: a bit per block says whether anything in it is visible; an empty one is left at its far face.
#include "brace/skip_grid.glsl"

#define BRACE_SKIP

ivec2 brace_skip_strides = ivec2(brace_skip_params.plane.xy);  // words per row and per slice

int brace_skip(BraceRay ray, vec3 voxel, int i, float step) {
  const ivec3 block = brace_skip_block(voxel);
  const int at = block.z * brace_skip_strides.y + block.y * brace_skip_strides.x + (block.x >> 5);
  const bool occupied = ((texelFetch(brace_skip_words, at).x >> (block.x & 31)) & 1u) != 0u;
  return occupied ? 1 : brace_skip_leap_distance(ray, voxel, block, 1, step);
}
