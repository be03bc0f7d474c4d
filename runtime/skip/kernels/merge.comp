#version 460
// Eq. 1 of the paper in one pass: the smallest of the distances of all the maps named. With BRACE_MERGE_OR the
// same for bit planes: a bit is set where any plane named has it.
#include "bytes.glsl"

layout(local_size_x = 64) in;
#include "linear.glsl"

layout(binding = 1) uniform usamplerBuffer maps;  // 16 bytes per texel
layout(std430, binding = 2) buffer Merged { uvec4 merged[]; };
layout(std140, binding = 3) uniform List { uvec4 list[BRACE_MERGE_LIST_QUADS]; };  // indices of maps
layout(push_constant) uniform Params {
  uint quads;    // per map
  uint stride;   // from map to map, in quads
  uint first;    // of the list
  uint count;    // maps of the list to merge, at least 1
  uint base;     // quad of map 0
  uint onto;     // 1: merge with what is there already
} params;

void main() {
  const uint at = linear_invocation();
  if (at >= params.quads) return;
#if defined(BRACE_MERGE_OR)
  uvec4 result = params.onto != 0u ? merged[at] : uvec4(0u);
#else
  uvec4 result = params.onto != 0u ? merged[at] : uvec4(BRACE_FAR);
#endif
  for (uint i = params.first; i < params.first + params.count; ++i) {
    const uvec4 other = texelFetch(maps, int(params.base + list[i >> 2][i & 3u] * params.stride + at));
#if defined(BRACE_MERGE_OR)
    result |= other;
#else
    result = min_bytes(result, other);
#endif
  }
  merged[at] = result;
}
