// Calls VISIT(KeyRange) with what a sample in a block can meet. The block must exist.
//   BRACE_OCCUPANCY 0  the interval of every interpolation cell that a sample in the block can fall into: the
//                      block's cells and those of one voxel around it (numerics: tight and exact)
//   BRACE_OCCUPANCY 1  one interval of all these
//   BRACE_OCCUPANCY 2  the block's own voxels, each by itself: loses thin bands that lie between voxel values
#ifndef BRACE_SKIP_BLOCK_CELLS_GLSL
#define BRACE_SKIP_BLOCK_CELLS_GLSL

#include "keys.glsl"

#if BRACE_OCCUPANCY == 2
#define BRACE_VISIT_BLOCK(block)                                                     \
  const int edge = int(build.blocks.w);                                              \
  const ivec3 begin = ivec3(block) * edge;                                           \
  const ivec3 end = min(begin + edge, ivec3(build.dims.xyz));                        \
  for (int z = begin.z; z < end.z; ++z)                                              \
    for (int y = begin.y; y < end.y; ++y)                                            \
      for (int x = begin.x; x < end.x; ++x) { BRACE_VISIT(voxel_range(ivec3(x, y, z))); }
#else
#define BRACE_VISIT_BLOCK(block)                                                     \
  const int edge = int(build.blocks.w);                                              \
  const ivec3 begin = ivec3(block) * edge - 1;                                       \
  const ivec3 last = min(begin + edge, ivec3(build.dims.xyz) - 1);                   \
  for (int y = begin.y; y <= last.y; ++y)                                            \
    for (int x = begin.x; x <= last.x; ++x) {                                        \
      KeyRange below = face_range(ivec2(x, y), begin.z);                             \
      for (int z = begin.z; z <= last.z; ++z) {                                      \
        const KeyRange above = face_range(ivec2(x, y), min(z + 1, int(build.dims.z))); \
        BRACE_VISIT(merged(below, above));                                           \
        below = above;                                                               \
      }                                                                              \
    }
#endif

#endif
