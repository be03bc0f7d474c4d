#version 460
// The occupancy map of the distance-map method as published (Deakin and Knackstedt): every voxel of a block through
// the transfer function until one is visible.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler3D volume;
layout(binding = 1) uniform sampler2D transfer;  // 256 x 1, alpha in x
layout(binding = 2, r8ui) uniform writeonly uimage3D occupancy;

void main() {
  const ivec3 block = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(block, imageSize(occupancy)))) return;
  const ivec3 begin = block * 4;
  const ivec3 end = min(begin + 4, textureSize(volume, 0));
  for (int z = begin.z; z < end.z; ++z)
    for (int y = begin.y; y < end.y; ++y)
      for (int x = begin.x; x < end.x; ++x) {
        const float value = texelFetch(volume, ivec3(x, y, z), 0).x;
        if (texelFetch(transfer, ivec2(int(value * 255.0 + 0.5), 0), 0).x > 0.0) {
          imageStore(occupancy, block, uvec4(0u));
          return;
        }
      }
  imageStore(occupancy, block, uvec4(255u));
}
