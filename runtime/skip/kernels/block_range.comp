#version 460
// The smallest and the largest key that a sample in a block can meet: low half and high half of a word per block.
#include "block_cells.glsl"

layout(local_size_x = 64) in;
#include "linear.glsl"

layout(std430, binding = 2) writeonly buffer Ranges { uint ranges[]; };  // of the slab, blocks in padded rows
layout(push_constant) uniform SlabBlock { SkipBuildSlab slab; };

void main() {
  const uint row = build.texel_grid.z;
  const uint at = linear_invocation();
  if (at >= row * build.blocks.y * slab.slices) return;
  const uvec3 block = uvec3(at % row, at / row % build.blocks.y, at / row / build.blocks.y + slab.first_slice);
  KeyRange whole = KeyRange(65535u, 0u);  // of no block: empty
  if (block.x < build.blocks.x) {
#define BRACE_VISIT(range) whole = merged(whole, range)
    BRACE_VISIT_BLOCK(block)
  }
  ranges[at] = whole.low | whole.high << 16;
}
