#version 460
// One pass over the volume for all partitions: for each block a bit per partition that a sample in it can fall
// into. The interval of a cell is the run of bits from the partition of its smallest to that of its largest key.
// BRACE_MASK_WORDS: 32-bit words per block.
#include "block_cells.glsl"

layout(local_size_x = 64) in;
#include "linear.glsl"

layout(binding = 1) uniform usamplerBuffer partition_of;  // by key
layout(std430, binding = 2) writeonly buffer Masks { uint masks[]; };  // of the slab, blocks in padded rows
layout(push_constant) uniform SlabBlock { SkipBuildSlab slab; };

// Bits low ... high of a mask, as far as they fall into the word of bits 32 word ... 32 word + 31.
uint run_in_word(int low, int high, int word) {
  const int first = max(low - 32 * word, 0);
  const int last = min(high - 32 * word, 31);
  return first <= last ? (0xffffffffu << first) & (0xffffffffu >> (31 - last)) : 0u;
}

void main() {
  const uint row = build.texel_grid.z;
  const uint at = linear_invocation();
  if (at >= row * build.blocks.y * slab.slices) return;
  const uvec3 block = uvec3(at % row, at / row % build.blocks.y, at / row / build.blocks.y + slab.first_slice);
  uint m0 = 0u, m1 = 0u, m2 = 0u, m3 = 0u, m4 = 0u, m5 = 0u, m6 = 0u, m7 = 0u;
  if (block.x < build.blocks.x) {
#if BRACE_OCCUPANCY == 1
    KeyRange whole = KeyRange(0xffffffffu, 0u);
#define BRACE_VISIT(range) whole = merged(whole, range)
    BRACE_VISIT_BLOCK(block)
    const int low = int(texelFetch(partition_of, int(whole.low)).x);
    const int high = int(texelFetch(partition_of, int(whole.high)).x);
#else
    int low, high;
#define BRACE_VISIT(range)                                         \
  const KeyRange cell = range;                                     \
  low = int(texelFetch(partition_of, int(cell.low)).x);            \
  high = int(texelFetch(partition_of, int(cell.high)).x);          \
  BRACE_ADD_RUN
#endif
#define BRACE_ADD_RUN BRACE_ADD_0 BRACE_ADD_1 BRACE_ADD_2 BRACE_ADD_3
#define BRACE_ADD_0 m0 |= run_in_word(low, high, 0);
#if BRACE_MASK_WORDS > 1
#define BRACE_ADD_1 m1 |= run_in_word(low, high, 1);
#else
#define BRACE_ADD_1
#endif
#if BRACE_MASK_WORDS > 2
#define BRACE_ADD_2 m2 |= run_in_word(low, high, 2); m3 |= run_in_word(low, high, 3);
#else
#define BRACE_ADD_2
#endif
#if BRACE_MASK_WORDS > 4
#define BRACE_ADD_3 m4 |= run_in_word(low, high, 4); m5 |= run_in_word(low, high, 5); m6 |= run_in_word(low, high, 6); m7 |= run_in_word(low, high, 7);
#else
#define BRACE_ADD_3
#endif
#if BRACE_OCCUPANCY == 1
    BRACE_ADD_RUN
#else
    BRACE_VISIT_BLOCK(block)
#endif
  }
  const uint out_at = at * BRACE_MASK_WORDS;
  masks[out_at] = m0;
#if BRACE_MASK_WORDS > 1
  masks[out_at + 1u] = m1;
#endif
#if BRACE_MASK_WORDS > 2
  masks[out_at + 2u] = m2;
#endif
#if BRACE_MASK_WORDS > 3
  masks[out_at + 3u] = m3;
#endif
#if BRACE_MASK_WORDS > 4
  masks[out_at + 4u] = m4;
#endif
#if BRACE_MASK_WORDS > 5
  masks[out_at + 5u] = m5;
#endif
#if BRACE_MASK_WORDS > 6
  masks[out_at + 6u] = m6;
#endif
#if BRACE_MASK_WORDS > 7
  masks[out_at + 7u] = m7;
#endif
}
