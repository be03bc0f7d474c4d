/* What the kernels that read the volume know. One text for C++ and GLSL (std140). */
#ifndef BRACE_SKIP_BUILD_PARAMS_H
#define BRACE_SKIP_BUILD_PARAMS_H

#define BRACE_SKIP_SLOT_PARAMS 0
#define BRACE_SKIP_SLOT_VOLUME 5

#ifdef __cplusplus
#include <cstdint>
#define BRACE_UVEC4(name) std::uint32_t name[4]
namespace brace {
#else
#define BRACE_UVEC4(name) uvec4 name
#endif

struct SkipBuildParams {
  BRACE_UVEC4(dims);       /* xyz: voxels; w: largest key of an integer type */
  BRACE_UVEC4(blocks);     /* xyz: blocks; w: voxels along a block's edge */
  BRACE_UVEC4(texel_grid); /* x: texels per row, y: per slice of a packed volume; z: blocks per padded row */
};

/* The part of the blocks that one dispatch works on: slices of blocks. */
struct SkipBuildSlab {
#ifdef __cplusplus
  std::uint32_t first_slice;
  std::uint32_t slices;
#else
  uint first_slice;
  uint slices;
#endif
};

#ifdef __cplusplus
}
static_assert(sizeof(brace::SkipBuildParams) == 48 && sizeof(brace::SkipBuildSlab) == 8);
#endif
#undef BRACE_UVEC4

#endif
