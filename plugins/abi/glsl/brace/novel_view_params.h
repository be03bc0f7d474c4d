/* What the novel view kernel knows of one eye: where the layers were cast from, and where it looks from now.
 * One text for C++ and GLSL (std140: only vec4 and uvec4). Metres, in the eye frame that the layers were cast
 * in, "old".
 */
#ifndef BRACE_NOVEL_VIEW_PARAMS_H
#define BRACE_NOVEL_VIEW_PARAMS_H

#ifdef __cplusplus
#include <cstdint>
#define BRACE_VEC4(name) float name[4]
#define BRACE_VEC4S(name, count) float name[count][4]
#define BRACE_UVEC4(name) std::uint32_t name[4]
namespace brace {
#else
#define BRACE_VEC4(name) vec4 name
#define BRACE_VEC4S(name, count) vec4 name[count]
#define BRACE_UVEC4(name) uvec4 name
#endif

struct BraceNovelViewParams {
  BRACE_VEC4(fov);  /* of the new picture: xy: tangents of the upper left corner; zw: tangents per pixel,
                       z to the right, w downwards (negative) */
  BRACE_VEC4(rays); /* the same of the grid of rays that the layers are of */
  BRACE_VEC4S(old_from_new, 4);  /* the rotation's columns, then where the new eye stands */
  BRACE_VEC4S(box_from_old, 3);  /* rows: direction along a box axis; w: coordinate of the old eye */
  BRACE_VEC4(box_half);          /* xyz: half the box's edges */
  BRACE_UVEC4(grid);             /* xy: pixels across and down; zw: rays across and down */
  BRACE_VEC4S(old_from_last, 4); /* old_from_new at the photons of the scan-out's last line, where a warp is
                                    by line; old_from_new is then that of the first */
};

#ifdef __cplusplus
}
static_assert(sizeof(brace::BraceNovelViewParams) == 240);
#endif
#undef BRACE_VEC4
#undef BRACE_VEC4S
#undef BRACE_UVEC4

#endif
