/* The coarser levels of the volume. One text for C++ and GLSL (std430). */
#ifndef BRACE_LEVEL_PARAMS_H
#define BRACE_LEVEL_PARAMS_H

#define BRACE_LEVELS_MAX 8

#ifdef __cplusplus
#include <cstdint>
#define BRACE_VEC4(name) float name[4]
#define BRACE_UVEC4(name) std::uint32_t name[4]
namespace brace {
#else
#define BRACE_VEC4(name) vec4 name
#define BRACE_UVEC4(name) uvec4 name
#endif

struct BraceLevel {
  BRACE_UVEC4(place); /* x: first texel; y: texels per row; z: per slice */
  BRACE_VEC4(scale);  /* xyz: voxels of the level per voxel of the volume */
};

struct BraceLevelTable {
  BRACE_UVEC4(last);                       /* x: the coarsest level; 0: there is none */
  BraceLevel levels[BRACE_LEVELS_MAX + 1]; /* [0] is unused: the volume itself is bound elsewhere */
};

#ifdef __cplusplus
}
static_assert(sizeof(brace::BraceLevelTable) == 16 + 32 * (BRACE_LEVELS_MAX + 1));
#endif
#undef BRACE_VEC4
#undef BRACE_UVEC4

#endif
