/* What the kernels of rays/mab know of one eye's levels. One text for C++ and GLSL (std430). */
#ifndef BRACE_MAB_PARAMS_H
#define BRACE_MAB_PARAMS_H

#define BRACE_MAB_LEVELS_MAX 8

#ifdef __cplusplus
#include <cstdint>
#define BRACE_UVEC4(name) std::uint32_t name[4]
#define BRACE_UVEC4_ARRAY(name, count) std::uint32_t name[count][4]
namespace brace {
#else
#define BRACE_UVEC4(name) uvec4 name
#define BRACE_UVEC4_ARRAY(name, count) uvec4 name[count]
#endif

struct BraceMabParams {
  BRACE_UVEC4(counts); /* x: levels */
  BRACE_UVEC4_ARRAY(level,
                    BRACE_MAB_LEVELS_MAX); /* xy: texels across and down; z: number of the first texel */
};

#ifdef __cplusplus
}
static_assert(sizeof(brace::BraceMabParams) == 144);
#endif
#undef BRACE_UVEC4
#undef BRACE_UVEC4_ARRAY

#endif
