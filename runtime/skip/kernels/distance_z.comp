#version 460
// Third part: one step of the sweeps along z, slice by slice: D = min(D, 1 + min of the 3 x 3 neighbours in the
// slice before). An invocation takes four rows of 16 bytes, so that the minima along x serve three rows each.
#include "bytes.glsl"

layout(local_size_x = 64) in;
#include "linear.glsl"

layout(binding = 1) uniform usamplerBuffer before;  // the maps, read where the step before wrote
layout(std430, binding = 2) buffer Maps { uvec4 maps[]; };
layout(push_constant) uniform Params {
  uint row_quads;
  uint rows;
  uint map_stride;  // quads
  uint from;        // first quad of the slice before, in a map
  uint to;          // … of the slice
  uint base;        // of the first map in `before`
} params;

uvec4 row_minimum(uint map, int column, int row) {
  row = clamp(row, 0, int(params.rows) - 1);
  const int at = int(params.base + map * params.map_stride + params.from + uint(row) * params.row_quads) + column;
  const uint left = column > 0 ? texelFetch(before, at - 1).w : BRACE_FAR;
  const uint right = column + 1 < int(params.row_quads) ? texelFetch(before, at + 1).x : BRACE_FAR;
  return min_of_three(left, texelFetch(before, at), right);
}

void main() {
  const uint item = linear_invocation();
  const uint column = item % params.row_quads;
  const uint row = item / params.row_quads * 4u;
  if (row >= params.rows) return;
  const uint map = gl_WorkGroupID.z;
  const uint to = map * params.map_stride + params.to + column;
  uvec4 a = row_minimum(map, int(column), int(row) - 1);
  uvec4 b = row_minimum(map, int(column), int(row));
  for (uint r = row; r < min(row + 4u, params.rows); ++r) {
    const uvec4 c = row_minimum(map, int(column), int(r) + 1);
    const uint at = to + r * params.row_quads;
    maps[at] = min_bytes(maps[at], min_bytes(a, min_bytes(b, c)) + 0x01010101u);
    a = b;
    b = c;
  }
}
