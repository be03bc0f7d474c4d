#version 460
// From planes back to a mask per block, rows not padded: the lowest level of the octree.
layout(local_size_x = 64) in;
#include "linear.glsl"

layout(binding = 1) uniform usamplerBuffer planes;
layout(std430, binding = 2) writeonly buffer Nodes { uint nodes[]; };
layout(push_constant) uniform Params {
  uvec4 blocks;        // xyz; w: words per mask
  uint row_words;      // of a plane
  uint plane_stride;   // words
  uint planes_count;
  uint padding;
} params;

void main() {
  const uint item = linear_invocation();
  const uint words = params.blocks.w;
  if (item >= params.blocks.x * params.blocks.y * params.blocks.z * words) return;
  const uint block = item / words;
  const uint first = item % words * 32u;
  const uint x = block % params.blocks.x;
  const uint at = block / params.blocks.x * params.row_words + (x >> 5);
  uint mask = 0u;
  for (uint p = first; p < min(first + 32u, params.planes_count); ++p)
    mask |= ((texelFetch(planes, int(p * params.plane_stride + at)).x >> (x & 31u)) & 1u) << (p - first);
  nodes[item] = mask;
}
