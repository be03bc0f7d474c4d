// skip/octree: a bit-field per node, a bit per partition of the values; a node is empty when it shares no bit with
// the transfer function's (Faludi et al.). The largest empty node around a sample is left at its far face.
#include "brace/skip_grid.glsl"

#define BRACE_SKIP

int brace_octree_levels = int(brace_skip_params.octree.x);
uint brace_octree_words = brace_skip_params.octree.y;  // per node

bool brace_octree_is_empty(ivec3 node, int level) {
  const uvec4 size = brace_skip_params.level[level];
  const int at = int(size.w + ((uint(node.z) * size.y + uint(node.y)) * size.x + uint(node.x)) * brace_octree_words);
  uint shown = 0u;
  for (uint w = 0u; w < brace_octree_words; ++w)
    shown |= texelFetch(brace_skip_words, at + int(w)).x & brace_skip_params.visible[w >> 2][w & 3u];
  return shown == 0u;
}

int brace_skip(BraceRay ray, vec3 voxel, int i, float step) {
  const ivec3 block = brace_skip_block(voxel);
  int level = 0;
  while (level < brace_octree_levels && brace_octree_is_empty(block >> level, level)) ++level;
  if (level == 0) return 1;
  const float edge = brace_skip_edge.x * float(1 << (level - 1));
  const vec3 low = vec3(block >> (level - 1)) * edge;
  return brace_skip_leap(ray, voxel, low, low + edge, step);
}
