/* What the kernels of stereo/layers know in one frame of a picture that they compose: the second eye's, or
 * one of a pair's. One text for C++ and GLSL (std430). Lengths are in units (the smallest voxel spacing),
 * columns and rows in pixels; where the composed eye is to the left of the one that is cast, both count
 * columns from the right.
 */
#ifndef BRACE_STEREO_PARAMS_H
#define BRACE_STEREO_PARAMS_H

#ifdef __cplusplus
#include <cstdint>
#define BRACE_VEC4(name) float name[4]
#define BRACE_IVEC4(name) std::int32_t name[4]
#define BRACE_UVEC4(name) std::uint32_t name[4]
namespace brace {
#else
#define BRACE_VEC4(name) vec4 name
#define BRACE_IVEC4(name) ivec4 name
#define BRACE_UVEC4(name) uvec4 name
#endif

struct BraceStereoParams {
  BRACE_VEC4(forward);  /* xyz: the eyes' view direction, volume axes, metric, of length 1 */
  BRACE_VEC4(line);     /* a ray of column c falls on column x * c + y - z / depth of the layers */
  BRACE_VEC4(depths);   /* x, y: depths between which the volume lies */
  BRACE_VEC4(tangents); /* second eye: x: at its left edge, y: per pixel; z: at its top edge, w: per pixel */
  BRACE_VEC4(rows);     /* a row r of the second eye lies on row x * r + y of the first */
  BRACE_IVEC4(grid);    /* xy: rays left of and above the first eye's picture; zw: rays across and down */
  BRACE_UVEC4(layers);  /* x: layers; y: this frame's number, 1 to 65535; zw: the second eye's picture */
  BRACE_VEC4(columns);  /* of the layers: x: per pixel of the second eye; y: across */
  BRACE_UVEC4(first); /* x: its first texel; y: its first ray; z: 1: columns count from the right; w: pictures
                         per eye */
};

#ifdef __cplusplus
}
static_assert(sizeof(brace::BraceStereoParams) == 144);
#endif
#undef BRACE_VEC4
#undef BRACE_IVEC4
#undef BRACE_UVEC4

#endif
