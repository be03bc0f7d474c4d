// Skipping by a map of Chebyshev distances, a byte per block, four to a word: the hook of every stage that keeps
// such a map.
#ifndef BRACE_SKIP_DISTANCE_GLSL
#define BRACE_SKIP_DISTANCE_GLSL

#include "brace/skip_grid.glsl"

#define BRACE_SKIP

ivec2 brace_skip_strides = ivec2(brace_skip_params.map.xy);  // words per row and per slice

int brace_skip(BraceRay ray, vec3 voxel, int i, float step) {
  const ivec3 block = brace_skip_block(voxel);
  const int at = block.z * brace_skip_strides.y + block.y * brace_skip_strides.x + (block.x >> 2);
  const uint word = texelFetch(brace_skip_words, at).x;
  const int distance = int((word >> ((block.x & 3) * 8)) & 255u);
  return distance > 0 ? brace_skip_leap_distance(ray, voxel, block, distance, step) : 1;
}

#endif
