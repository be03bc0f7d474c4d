/* What the skip stages' snippets know of their structure. One text for C++ and GLSL (std140). */
#ifndef BRACE_SKIP_PARAMS_H
#define BRACE_SKIP_PARAMS_H

#define BRACE_SKIP_LEVELS_MAX 16

#ifdef __cplusplus
#include <cstdint>
#define BRACE_VEC4(name) float name[4]
#define BRACE_UVEC4(name) std::uint32_t name[4]
#define BRACE_UVEC4_ARRAY(name, count) std::uint32_t name[count][4]
namespace brace {
#else
#define BRACE_VEC4(name) vec4 name
#define BRACE_UVEC4(name) uvec4 name
#define BRACE_UVEC4_ARRAY(name, count) uvec4 name[count]
#endif

struct BraceSkipParams {
  BRACE_UVEC4(blocks); /* xyz: blocks along each axis; w: voxels along a block's edge */
  BRACE_VEC4(edge);    /* x: voxels along a block's edge; y: its inverse */
  BRACE_UVEC4(map);    /* distances, four blocks to a word: x: words per row, y: per slice */
  BRACE_UVEC4(plane);  /* bits, 32 blocks to a word: x: words per row, y: per slice */
  BRACE_UVEC4(octree); /* x: levels, y: words per node */
  BRACE_UVEC4_ARRAY(level, BRACE_SKIP_LEVELS_MAX); /* xyz: nodes along each axis; w: first word */
  BRACE_UVEC4_ARRAY(visible, 2); /* a bit per partition: does the transfer function show it */
};

/* What an earlier eye frame has seen: the view it was cast from, and where its first hits are. std430. */
struct BraceOcclusionParams {
  BRACE_VEC4(
      column);     /* xyz, times a vector in voxels from the old eye: image column in tiles, times `ahead` */
  BRACE_VEC4(row); /* … image row in tiles, times `ahead`; w: refresh_frames, 0: never */
  BRACE_VEC4(ahead); /* … units in front of the old eye; w: distance between pixels per distance */
  BRACE_VEC4(eye);   /* xyz: the old eye in voxel coordinates */
  BRACE_UVEC4(
      tiles); /* xy: tiles across and down, 0 where nothing is remembered; z: frames since; w: tile, px */
};

#ifdef __cplusplus
}
static_assert(sizeof(brace::BraceSkipParams) == 16 * (5 + BRACE_SKIP_LEVELS_MAX + 2));
static_assert(sizeof(brace::BraceOcclusionParams) == 80);
#endif
#undef BRACE_VEC4
#undef BRACE_UVEC4
#undef BRACE_UVEC4_ARRAY

#endif
