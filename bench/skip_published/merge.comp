#version 460
// The merge as published: at most six maps and the result so far in a pass, textures flip-flopping.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler3D before;
layout(binding = 1) uniform usampler3D map0;
layout(binding = 3) uniform usampler3D map1;
layout(binding = 4) uniform usampler3D map2;
layout(binding = 5) uniform usampler3D map3;
layout(binding = 6) uniform usampler3D map4;
layout(binding = 7) uniform usampler3D map5;
layout(binding = 2, r8ui) uniform writeonly uimage3D to;
layout(push_constant) uniform Params { int maps; int onto; } params;

void main() {
  const ivec3 block = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(block, imageSize(to)))) return;
  uint nearest = texelFetch(map0, block, 0).x;
  if (params.onto != 0) nearest = min(nearest, texelFetch(before, block, 0).x);
  if (params.maps > 1) nearest = min(nearest, texelFetch(map1, block, 0).x);
  if (params.maps > 2) nearest = min(nearest, texelFetch(map2, block, 0).x);
  if (params.maps > 3) nearest = min(nearest, texelFetch(map3, block, 0).x);
  if (params.maps > 4) nearest = min(nearest, texelFetch(map4, block, 0).x);
  if (params.maps > 5) nearest = min(nearest, texelFetch(map5, block, 0).x);
  imageStore(to, block, uvec4(nearest));
}
