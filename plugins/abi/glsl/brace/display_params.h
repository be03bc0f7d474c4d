/* What the display kernel and warp stages know of one eye's panel, lens and source picture. One text for C++
 * and GLSL (std140: only vec4 and uvec4).
 *
 * From a panel pixel to a source pixel, per colour channel:
 *   display point  p = pixel * pitch.xy + centre.xy        lens units, y up, (0, 0) on the lens' axis
 *   tangents       t = p * L(|p|) * pitch.zw               direction (t.x, t.y, -1) in the new eye frame
 *   warp stage     t' = brace_warp_source(t)               direction in the eye frame of the source picture
 *   source pixel   s = t' * source.xy + source.zw          (0, 0) is the centre of the upper left pixel
 */
#ifndef BRACE_DISPLAY_PARAMS_H
#define BRACE_DISPLAY_PARAMS_H

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

struct BraceDisplayParams {
  BRACE_VEC4(pitch);      /* xy: lens units per panel pixel (y negative); zw: tangents per lens unit */
  BRACE_VEC4S(centre, 3); /* red, green, blue. xy: display point of panel pixel (0, 0); z: usable radius,
                             squared; w: k4 */
  BRACE_VEC4S(lens, 3);   /* k0 … k3 */
  BRACE_VEC4(source);     /* xy: source pixels per tangent (y negative); zw: source pixel of tangent 0 */
  BRACE_VEC4(source_max); /* xy: largest coordinate to fetch from; zw: width and height - 0.5 */
  BRACE_VEC4(fov);        /* tangents that the eye sees: left, bottom, right, top */
  BRACE_VEC4S(old_from_new, 4);  /* from the new eye frame to the source picture's: the rotation's columns,
                                    then the translation in metres. w of the first two: how far
                                   from the old eye the scene begins and ends; 0, 1e30: not known */
  BRACE_UVEC4(grid);             /* x: source pixels per row; y: groups of four panel pixels per row;
                      zw: panel pixels across and down */
  BRACE_VEC4S(old_from_last, 4); /* old_from_new at the photons of the scan-out's last line; old_from_new is
                                    then that of the first. The same where a warp is not by line */
  BRACE_VEC4(scan);              /* from the first line (0) to the last (1): dot(panel pixel, xy) + z */
};

#ifdef __cplusplus
}
static_assert(sizeof(brace::BraceDisplayParams) == 320);
#endif
#undef BRACE_VEC4
#undef BRACE_VEC4S
#undef BRACE_UVEC4

#endif
