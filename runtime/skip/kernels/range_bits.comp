#version 460
// From a key range per block to a bit per block: is any key of the range visible? visible_below[k] is the number of
// visible keys below k. An invocation makes a word of 32 blocks.
layout(local_size_x = 64) in;
#include "linear.glsl"

layout(binding = 1) uniform usamplerBuffer ranges;
layout(binding = 4) uniform usamplerBuffer visible_below;
layout(std430, binding = 2) writeonly buffer Plane { uint plane[]; };
layout(push_constant) uniform Params {
  uint words;
} params;

void main() {
  const uint word = linear_invocation();
  if (word >= params.words) return;
  uint bits = 0u;
  for (int x = 0; x < 32; ++x) {
    const uint range = texelFetch(ranges, int(word) * 32 + x).x;
    const int low = int(range & 65535u);
    const int high = int(range >> 16);
    // An empty range has low > high.
    const bool visible =
        low <= high && texelFetch(visible_below, high + 1).x != texelFetch(visible_below, low).x;
    bits |= uint(visible) << x;
  }
  plane[word] = bits;
}
