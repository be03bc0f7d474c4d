// The layers in memory: rows of the ray grid, in each the layers, in each the columns of the second eye. Texels
// are premultiplied. Nothing is cleared: a texel counts if the ray that owns it in this frame says so.
#include "brace/stereo_params.h"

// No uniform block: Mesa 22.3's lavapipe inlines uniforms that conditions depend on, and crashes where a skip stage's
// block has some as well.
layout(std430, set = 0, binding = 16) readonly buffer BraceStereoBlock { BraceStereoParams stereo; };

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

// Per ray: x: first column it wrote and the one after its last (upper 16 bits); y: the frame in which it did.
layout(std430, set = 0, binding = 18) buffer BraceStereoRanges { uvec2 stereo_ranges[]; };

// The first texel of a ray's layer. Neighbouring rays have different layers, as many rays apart as there are
// layers share one and never meet (Buchacher, Algorithm 1, whose layers count the other way round).
uint stereo_row_of(uvec2 cell) {
  return (cell.y * stereo.layers.x + cell.x % stereo.layers.x) * stereo.layers.z;
}
