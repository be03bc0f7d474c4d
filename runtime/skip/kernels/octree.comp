#version 460
// The next level of the bit-field octree: a node's mask is the OR of its up to eight children's.
layout(local_size_x = 64) in;
#include "linear.glsl"

layout(binding = 1) uniform usamplerBuffer below;  // all levels, words
layout(std430, binding = 2) writeonly buffer Nodes { uint nodes[]; };  // of this level
layout(push_constant) uniform Params {
  uvec4 children;  // xyz: nodes of the level below; w: its first word
  uvec4 size;      // xyz: nodes of this level; w: words per mask
} params;

void main() {
  const uint item = linear_invocation();
  const uint words = params.size.w;
  if (item >= params.size.x * params.size.y * params.size.z * words) return;
  const uint node = item / words;
  const uvec3 at = uvec3(node % params.size.x, node / params.size.x % params.size.y, node / params.size.x / params.size.y);
  uint mask = 0u;
  for (uint child = 0u; child < 8u; ++child) {
    const uvec3 c = at * 2u + uvec3(child & 1u, (child >> 1) & 1u, child >> 2);
    if (any(greaterThanEqual(c, params.children.xyz))) continue;
    const uint index = (c.z * params.children.y + c.y) * params.children.x + c.x;
    mask |= texelFetch(below, int(params.children.w + index * words + item % words)).x;
  }
  nodes[item] = mask;
}
