#version 460
// Two 32-bit hashes of every row of voxels; the host goes on with them.
#include "keys.glsl"

layout(local_size_x = 64) in;
#include "linear.glsl"

layout(std430, binding = 2) writeonly buffer Hashes { uvec2 hashes[]; };
layout(push_constant) uniform Params {
  uint rows;
} params;

uint voxel_bits(ivec3 voxel) {
#if defined(BRACE_VOLUME_TEXELS_32)
  const int at = (voxel.z + 1) * int(build.texel_grid.y) + (voxel.y + 1) * int(build.texel_grid.x) + voxel.x + 1;
  return floatBitsToUint(texelFetch(voxels, at).x);
#elif defined(BRACE_SKIP_FLOAT)
  return floatBitsToUint(texelFetch(voxels, voxel, 0).x);
#else
  return voxel_range(voxel).low;
#endif
}

void main() {
  const uint row = linear_invocation();
  if (row >= params.rows) return;
  uvec2 hash = uvec2(2166136261u, 2654435769u);
  for (uint x = 0u; x < build.dims.x; ++x) {
    const uint bits = voxel_bits(ivec3(x, row % build.dims.y, row / build.dims.y));
    hash = (hash ^ bits) * uvec2(16777619u, 2246822519u);
    hash ^= hash >> 15;
  }
  hashes[row] = hash;
}
