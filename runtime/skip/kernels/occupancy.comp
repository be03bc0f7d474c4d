#version 460
// skip/distance_map: occupancy from the volume itself for one transfer function, a word of 32 blocks per work-group
// of 32 invocations. A cell is occupied when any key from its smallest to its largest is visible.
#include "block_cells.glsl"

layout(local_size_x = 32) in;

layout(std430, binding = 2) writeonly buffer Plane { uint plane[]; };
layout(binding = 4) uniform usamplerBuffer visible_below;  // visible_below[k]: visible keys below k
layout(push_constant) uniform SlabBlock { SkipBuildSlab slab; };

shared uint occupied[32];

bool is_visible(KeyRange cell) {
  return texelFetch(visible_below, int(cell.high) + 1).x != texelFetch(visible_below, int(cell.low)).x;
}

bool block_is_occupied(uvec3 block) {
  bool any_visible = false;
#if BRACE_OCCUPANCY == 1
  KeyRange whole = KeyRange(65535u, 0u);
#define BRACE_VISIT(range) whole = merged(whole, range)
  BRACE_VISIT_BLOCK(block)
  any_visible = is_visible(whole);
#else
#define BRACE_VISIT(range) if (is_visible(range)) return true
  BRACE_VISIT_BLOCK(block)
#endif
  return any_visible;
}

void main() {
  const uint word = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  const uint row_words = build.texel_grid.z / 32u;
  const uint rows = build.blocks.y * slab.slices;
  const uint lane = gl_LocalInvocationID.x;
  const uint row = word / row_words;
  const uvec3 block = uvec3(word % row_words * 32u + lane, row % build.blocks.y, row / build.blocks.y + slab.first_slice);
  const bool exists = row < rows && block.x < build.blocks.x;
  occupied[lane] = exists && block_is_occupied(block) ? 1u << lane : 0u;
  barrier();
  if (lane != 0u || row >= rows) return;
  uint bits = 0u;
  for (uint i = 0u; i < 32u; ++i) bits |= occupied[i];
  plane[word] = bits;
}
