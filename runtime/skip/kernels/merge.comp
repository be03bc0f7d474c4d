#version 460
// Eq. 1 of the paper: the smallest of the distances of BRACE_MERGE_MAPS maps, in one pass. With BRACE_MERGE_OR the
// same for bit planes: a bit is set where any plane has it. The maps are named by constants and the loop is
// unrolled: a software device fetches three times as fast as when it looks each one up in a list.
#extension GL_EXT_control_flow_attributes : require
#include "bytes.glsl"

layout(local_size_x = 64) in;
#include "linear.glsl"

layout(binding = 1) uniform usamplerBuffer maps;  // 16 bytes per texel
layout(std430, binding = 2) buffer Merged { uvec4 merged[]; };
layout(push_constant) uniform Params {
  uint quads;                    // per map
  uint onto;                     // 1: merge with what is there already
  uint first[BRACE_MERGE_MAPS];  // quad of each map
} params;

void main() {
  const uint at = linear_invocation();
  if (at >= params.quads) return;
#if defined(BRACE_MERGE_OR)
  uvec4 result = params.onto != 0u ? merged[at] : uvec4(0u);
  [[unroll]] for (int i = 0; i < BRACE_MERGE_MAPS; ++i) result |= texelFetch(maps, int(params.first[i] + at));
  merged[at] = result;
#else
  uvec4 result = BRACE_FREE_BITS | (params.onto != 0u ? merged[at] : uvec4(BRACE_FAR));
  [[unroll]] for (int i = 0; i < BRACE_MERGE_MAPS; ++i)
    result = nearer_bytes(result, texelFetch(maps, int(params.first[i] + at)));
  merged[at] = result & BRACE_FAR;
#endif
}
