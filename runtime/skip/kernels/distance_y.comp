#version 460
// Second part: sweeps forward and backward along y with a minimum of three along x. A work-group takes a slice;
// the rows of a slice are done one after the other. D = min(D, 1 + min of the neighbours in the row before).
// BRACE_LOCAL: invocations of a work-group.
#include "bytes.glsl"

layout(local_size_x = BRACE_LOCAL) in;

layout(std430, binding = 2) coherent buffer Maps { uvec4 maps[]; };
layout(push_constant) uniform Params {
  uint row_quads;
  uint rows;
  uint map_stride;  // quads
} params;

void step_row(uint before, uint row) {
  for (uint c = gl_LocalInvocationID.x; c < params.row_quads; c += BRACE_LOCAL) {
    const uint left = c > 0u ? maps[before + c - 1u].w : BRACE_FAR;
    const uint right = c + 1u < params.row_quads ? maps[before + c + 1u].x : BRACE_FAR;
    const uvec4 nearest = min_of_three(left, maps[before + c], right);
    maps[row + c] = min_bytes(maps[row + c], nearest + 0x01010101u);
  }
  memoryBarrierBuffer();
  barrier();
}

void main() {
  const uint first = gl_WorkGroupID.y * params.map_stride + gl_WorkGroupID.x * params.row_quads * params.rows;
  for (uint y = 1u; y < params.rows; ++y)
    step_row(first + (y - 1u) * params.row_quads, first + y * params.row_quads);
  for (uint y = params.rows - 1u; y > 0u; --y)
    step_row(first + y * params.row_quads, first + (y - 1u) * params.row_quads);
}
