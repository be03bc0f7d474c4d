/* What stereo/resample_plane.comp knows of an eye's picture on two planes. One text for C++ and GLSL
 * (std430).
 */
#ifndef BRACE_PLANE_PARAMS_H
#define BRACE_PLANE_PARAMS_H

#ifdef __cplusplus
#include <cstdint>
#define BRACE_VEC4(name) float name[4]
#define BRACE_UVEC4(name) std::uint32_t name[4]
namespace brace {
#else
#define BRACE_VEC4(name) vec4 name
#define BRACE_UVEC4(name) uvec4 name
#endif

struct BracePlaneParams {
  BRACE_VEC4(base); /* xyz: direction of the new picture's upper left corner, in the frame of the old plane */
  BRACE_VEC4(across); /* xyz: what a pixel across adds to it */
  BRACE_VEC4(down);   /* xyz: what a pixel down adds */
  BRACE_VEC4(place);  /* tangents t of the old plane are its pixel (t - xy) * zw */
  BRACE_UVEC4(sizes); /* xy: of the old picture; zw: of the new one */
};

#ifdef __cplusplus
}
static_assert(sizeof(brace::BracePlaneParams) == 80);
#endif
#undef BRACE_VEC4
#undef BRACE_UVEC4

#endif
