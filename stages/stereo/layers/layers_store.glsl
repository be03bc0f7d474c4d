// The layers in memory: rows of the ray grid, in each the layers, in each the columns of the second eye. Texels
// are premultiplied. Nothing is cleared: a texel counts if the ray that owns it in this frame says so.
#include "brace/stereo_params.h"

// No uniform block: Mesa 22.3's lavapipe inlines uniforms that conditions depend on, and crashes where a skip stage's
// block has some as well.
layout(std430, set = 0, binding = 16) readonly buffer BraceStereoBlock { BraceStereoParams stereo_pictures[]; };
// The picture at hand: of an eye, and with rays/mab of one of its levels.
#if defined(BRACE_STEREO_BY_TEXEL) || defined(BRACE_STEREO_REFERENCE_MIDDLE)
uint stereo_picture = 0u;
#else
const uint stereo_picture = 0u;
#endif
#define stereo stereo_pictures[stereo_picture]

#if defined(BRACE_STEREO_FORMAT_RGBA8)
layout(std430, set = 0, binding = 17) buffer BraceStereoLayers { uint stereo_texels[]; };
void stereo_store(uint at, vec4 texel) { stereo_texels[at] = packUnorm4x8(texel); }
vec4 stereo_load(uint at) { return unpackUnorm4x8(stereo_texels[at]); }
#elif defined(BRACE_STEREO_FORMAT_RGBA16F)
layout(std430, set = 0, binding = 17) buffer BraceStereoLayers { uvec2 stereo_texels[]; };
void stereo_store(uint at, vec4 texel) { stereo_texels[at] = uvec2(packHalf2x16(texel.xy), packHalf2x16(texel.zw)); }
vec4 stereo_load(uint at) {
  const uvec2 texel = stereo_texels[at];
  return vec4(unpackHalf2x16(texel.x), unpackHalf2x16(texel.y));
}
#else
layout(std430, set = 0, binding = 17) buffer BraceStereoLayers { vec4 stereo_texels[]; };
void stereo_store(uint at, vec4 texel) { stereo_texels[at] = texel; }
vec4 stereo_load(uint at) { return stereo_texels[at]; }
#endif

// Per ray of a picture: x: first column it wrote and the one after its last (upper 16 bits); y: the frame in which it did and, if
// it was stopped, the column after the one where it would have left the volume, else 0 (upper 16 bits).
layout(std430, set = 0, binding = 18) buffer BraceStereoRanges { uvec2 stereo_ranges[]; };
// Texels written; texels that compositions read.
layout(std430, set = 0, binding = 19) buffer BraceStereoCounts { uint stereo_written, stereo_read; };

// Interleaved sampling (Keller and Heidrich 2001): of `stereo_interleave` neighbouring rays one leaves segments, and its
// columns are as many pixels wide; both are shifted from row to row.
int stereo_phase(uint row) { return int(row % uint(stereo_interleave)); }
bool stereo_is_sampled(uvec2 cell) { return (cell.x + cell.y) % uint(stereo_interleave) == 0u; }

// Columns count from the right where the composed eye is to the left of the rays'.
uvec2 stereo_in_order(uvec2 cell) {
  return uvec2(stereo.first.z != 0u ? uint(stereo.grid.z) - 1u - cell.x : cell.x, cell.y);
}
uint stereo_range_of(uvec2 cell) { return stereo.first.y + cell.y * uint(stereo.grid.z) + cell.x; }

// The first texel of a ray's layer. Neighbouring rays have different layers, as many rays apart as there are
// layers share one and never meet (Buchacher, Algorithm 1, whose layers count the other way round).
uint stereo_row_of(uvec2 cell) {
  const uint layer = cell.x / uint(stereo_interleave) % stereo.layers.x;
  return stereo.first.x + (cell.y * stereo.layers.x + layer) * uint(stereo.columns.y);
}
// The column of the layers where a ray's point at infinity falls; of the ray's column in the grid.
float stereo_line_of(int column, uint row) {
  return stereo.line.x * (float(column - stereo.grid.x) + 0.5) + stereo.line.y +
         stereo.columns.x * float(stereo_phase(row));
}
