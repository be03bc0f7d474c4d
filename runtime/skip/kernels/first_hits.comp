#version 460
// Per tile of an eye image: the nearest first hit of its pixels and of those one pixel around it, so that a ray
// between pixel centres has all its neighbours in the tile.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform samplerBuffer depths_m;                   // per pixel; +infinity without a hit
layout(std430, binding = 1) writeonly buffer Hits { float hits[]; };  // per tile, units
layout(push_constant) uniform Params {
  uvec4 image;  // xy: pixels; z: edge of a tile
  uvec4 tiles;  // xy: across and down
  vec4 scale;   // x: units per metre
} params;

void main() {
  const uvec2 tile = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(tile, params.tiles.xy))) return;
  const ivec2 size = ivec2(params.image.xy);
  const ivec2 low = max(ivec2(tile * params.image.z) - 1, ivec2(0));
  const ivec2 high = min(ivec2((tile + 1u) * params.image.z) + 1, size);
  float nearest = uintBitsToFloat(0x7f800000u);
  for (int y = low.y; y < high.y; ++y) {
    for (int x = low.x; x < high.x; ++x) nearest = min(nearest, texelFetch(depths_m, y * size.x + x).x);
  }
  hits[tile.y * params.tiles.x + tile.x] = nearest * params.scale.x;
}
