/* What every kernel knows of one eye in one frame. One text for C, C++ and GLSL (std140: only vec4 and
 * uvec4).
 *
 * Voxel coordinates: the volume's box is [0, dims]; voxel (i, j, k) has its value at (i, j, k) + 0.5; the
 * values beyond the outermost voxel centres are those of the edge.
 * One "unit" of length is the smallest voxel spacing; steps, ray lengths and optical depths are per unit.
 */
#ifndef BRACE_EYE_PARAMS_H
#define BRACE_EYE_PARAMS_H

#ifdef __cplusplus
#include <cstdint>
#define BRACE_VEC4(name) float name[4]
#define BRACE_UVEC4(name) std::uint32_t name[4]
namespace brace {
#elif defined(__STDC__)
#include <stdint.h>
#define BRACE_VEC4(name) float name[4]
#define BRACE_UVEC4(name) uint32_t name[4]
#else
#define BRACE_VEC4(name) vec4 name
#define BRACE_UVEC4(name) uvec4 name
#endif

struct BraceEyeParams {
  BRACE_VEC4(eye);      /* xyz: the eye in voxel coordinates; w: metres per unit */
  BRACE_VEC4(ray_base); /* xyz: direction through the image's upper left corner, volume axes, metric;
                           w: rays left of the image */
  BRACE_VEC4(ray_dx);   /* xyz: change of that direction per pixel to the right; w: rays above the image */
  BRACE_VEC4(ray_dy);   /* xyz: … per pixel downwards */
  BRACE_VEC4(voxels_per_unit); /* xyz: voxels along each axis per unit of length, at most 1 */
  BRACE_VEC4(volume_dims);     /* xyz: voxels along each axis */
  BRACE_VEC4(value);           /* value = raw * x + y: what the volume's texels mean in the data's units */
  BRACE_VEC4(transfer);        /* table coordinate = value * x + y; z: last entry; w: empty up to here */
  BRACE_UVEC4(grid);           /* xy: rays across and down; zw: pixels of the eye image across and down */
  BRACE_UVEC4(texel_grid);     /* packed volume: x: texels per row, y: per slice; zw: see brace_is_empty */
};

/* The part of the ray grid, or of the eye image in the closing brace, that one dispatch works on. */
struct BraceArea {
#ifdef __cplusplus
  std::uint32_t origin[2];
  std::uint32_t size[2];
#elif defined(__STDC__)
  uint32_t origin[2];
  uint32_t size[2];
#else
  uvec2 origin;
  uvec2 size;
#endif
};

#ifdef __cplusplus
}
static_assert(sizeof(brace::BraceEyeParams) == 160 && sizeof(brace::BraceArea) == 16);
#endif
#undef BRACE_VEC4
#undef BRACE_UVEC4

#endif
