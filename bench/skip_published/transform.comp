#version 460
// One of the three passes of the distance transform as published: along one axis, outwards from each block until no
// nearer distance can come, g(i) = min over j of max(|i - j|, f(j)).
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler3D from;
layout(binding = 2, r8ui) uniform writeonly uimage3D to;
layout(push_constant) uniform Params { int axis; } params;

void main() {
  const ivec3 block = ivec3(gl_GlobalInvocationID);
  const ivec3 size = imageSize(to);
  if (any(greaterThanEqual(block, size))) return;
  ivec3 along = ivec3(0);
  along[params.axis] = 1;
  const int place = block[params.axis];
  const int last = size[params.axis] - 1;
  uint nearest = texelFetch(from, block, 0).x;
  for (int away = 1; away < int(nearest) && away <= last; ++away) {
    if (place - away >= 0) nearest = min(nearest, max(uint(away), texelFetch(from, block - away * along, 0).x));
    if (place + away <= last) nearest = min(nearest, max(uint(away), texelFetch(from, block + away * along, 0).x));
  }
  imageStore(to, block, uvec4(nearest));
}
