#version 460
// First part of the exact Chebyshev transform: the distance along x to the nearest occupied block of the row,
// from a bit per block to a byte per block. An invocation makes 16 bytes.
#include "bytes.glsl"

layout(local_size_x = 64) in;
#include "linear.glsl"

layout(binding = 1) uniform usamplerBuffer planes;
layout(std430, binding = 2) writeonly buffer Maps { uvec4 maps[]; };
layout(push_constant) uniform Params {
  uint quads;         // 16-byte pieces of a map
  uint row_quads;
  uint row_words;     // 32-block words of a plane's row
  uint plane_stride;  // words
  uint map_stride;    // quads
  uint first_plane;
} params;

uint row_word(int base, int word) {
  return word >= 0 && word < int(params.row_words) ? texelFetch(planes, base + word).x : 0u;
}

void main() {
  const uint quad = linear_invocation();
  if (quad >= params.quads) return;
  const uint map = gl_WorkGroupID.z;
  const uint row = quad / params.row_quads;
  const int x = int(quad % params.row_quads) * 16;
  const int base = int((params.first_plane + map) * params.plane_stride + row * params.row_words);
  const int word = x >> 5;
  const int shift = x & 31;
  const uint here = row_word(base, word);
  const uint bits = (here >> shift) & 0xffffu;
  // Distances from the piece's ends to the nearest bit beyond them.
  int left = 127;
  const uint below = shift == 0 ? 0u : here & 0xffffu;
  if (below != 0u) left = 15 - findMSB(below);
  for (int away = 0; left == 127 && away < 128; away += 32) {
    const int w = word - 1 - (away >> 5);
    if (w < 0) break;
    const uint there = row_word(base, w);
    if (there != 0u) left = min(31 - findMSB(there) + away + shift, 127);
  }
  int right = 127;
  const uint above = shift == 0 ? here >> 16 : 0u;
  if (above != 0u) right = findLSB(above);
  for (int away = 0; right == 127 && away < 128; away += 32) {
    const int w = word + 1 + (away >> 5);
    if (w >= int(params.row_words)) break;
    const uint there = row_word(base, w);
    if (there != 0u) right = min(findLSB(there) + away + 16 - shift, 127);
  }
  // right counts from the block after the piece, left from the block before it.
  uvec4 forward = uvec4(0u);
  uint distance = uint(left);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      distance = ((bits >> (4 * i + j)) & 1u) != 0u ? 0u : min(distance + 1u, 127u);
      forward[i] |= distance << (8 * j);
    }
  }
  uvec4 backward = uvec4(0u);
  distance = uint(right);
  for (int i = 3; i >= 0; --i) {
    for (int j = 3; j >= 0; --j) {
      distance = ((bits >> (4 * i + j)) & 1u) != 0u ? 0u : min(distance + 1u, 127u);
      backward[i] |= distance << (8 * j);
    }
  }
  maps[map * params.map_stride + quad] = min_bytes(forward, backward);
}
