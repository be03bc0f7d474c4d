// The multiresolution atlas buffer of Waschk and Krueger: levels of falling resolution over the eye's picture,
// a ray only for those texels that the picture is put together from. Which those are is found on the host
// (runtime/mab).
#include "brace/mab_params.h"

layout(std430, set = 0, binding = 24) readonly buffer BraceMabBlock { BraceMabParams brace_mab; };
// Per ray: x | y << 14 | level << 28, or none.
layout(std430, set = 0, binding = 25) readonly buffer BraceMabTexels { uint brace_mab_texel_of_ray[]; };
// Per texel, level after level: the ray's number, or none.
layout(std430, set = 0, binding = 26) readonly buffer BraceMabRays { uint brace_mab_ray_of_texel[]; };
// Per pixel: where it stands in the weight table, 0 (finest) to 1.
layout(std430, set = 0, binding = 27) readonly buffer BraceMabCoordinates { float brace_mab_coordinates[]; };
// f_alpha: 256 entries per level.
layout(std430, set = 0, binding = 28) readonly buffer BraceMabWeights { float brace_mab_weights[]; };

// Per entry but the last: first | last << 8 of the levels that have a share up to the next one.
layout(std430, set = 0, binding = 29) readonly buffer BraceMabRanges { uint brace_mab_ranges[]; };

#define MAB_NONE 0xffffffffu

#if defined(BRACE_KERNEL_OPENING)
// f_gamma: the texel's place in the picture.
BraceRay brace_open(uvec2 cell) {
  const uint texel = brace_mab_texel_of_ray[brace_ray_index(cell)];
  if (texel == MAB_NONE) return BraceRay(vec3(0.0), 0.0, vec3(0.0), 0.0);
  const vec2 at = vec2(texel & 0x3fffu, texel >> 14 & 0x3fffu) + 0.5;
  const vec2 size = vec2(brace_mab.level[texel >> 28].xy);
  const vec2 picture = vec2(brace_eye.grid.zw);
  BraceRay ray = brace_ray_through(at * (picture / size));
  ray.level = log2(picture.x / size.x);
  return ray;
}
#endif

#if defined(BRACE_KERNEL_CLOSING)
struct MabSum {
  vec4 colour;
  float hit_share, hit_depth_m;  // depths of the rays that hit something, weighted
};

// Where a pixel stands in the weight table, and the levels that it is put together from: mostly one. Loops over
// them end there on every device; a branch around a level would run in full on some.
struct MabPlace {
  uint entry, first, last;
  float t;
};

MabPlace mab_place(uvec2 pixel) {
  const float place = brace_mab_coordinates[pixel.y * brace_eye.grid.z + pixel.x] * 255.0;
  const uint entry = min(uint(place), 254u);
  const uint range = brace_mab_ranges[entry];
  return MabPlace(entry, range & 0xffu, range >> 8, place - float(entry));
}

float mab_share(uint level, MabPlace place) {
  const uint at = level * 256u + place.entry;
  return brace_mab_weights[at] + place.t * (brace_mab_weights[at + 1u] - brace_mab_weights[at]);
}

void mab_add(inout MabSum sum, uint level, ivec2 texel, float share) {
  if (share == 0.0) return;
  const uvec2 size = brace_mab.level[level].xy;
  const uvec2 at = uvec2(clamp(texel, ivec2(0), ivec2(size) - 1));
  const uint ray = brace_mab_ray_of_texel[brace_mab.level[level].z + at.y * size.x + at.x];
  sum.colour += share * brace_result_colours[ray];
  const float depth_m = brace_result_depths_m[ray];
  if (depth_m != BRACE_NO_HIT) {
    sum.hit_share += share;
    sum.hit_depth_m += share * depth_m;
  }
}

vec4 mab_catmull_rom(float t) {
  return vec4(t * (-0.5 + t * (1.0 - 0.5 * t)), 1.0 + t * t * (1.5 * t - 2.5),
              t * (0.5 + t * (2.0 - 1.5 * t)), t * t * (0.5 * t - 0.5));
}

// f_beta: the pixel's place in a level.
void mab_add_level(inout MabSum sum, uint level, uvec2 pixel, float share) {
  const vec2 place = (vec2(pixel) + 0.5) * (vec2(brace_mab.level[level].xy) / vec2(brace_eye.grid.zw)) - 0.5;
  const vec2 low = floor(place);
  const vec2 t = place - low;
  const ivec2 texel = ivec2(low);
#if defined(BRACE_RAYS_FILTER_LINEAR)
  mab_add(sum, level, texel, share * (1.0 - t.x) * (1.0 - t.y));
  mab_add(sum, level, texel + ivec2(1, 0), share * t.x * (1.0 - t.y));
  mab_add(sum, level, texel + ivec2(0, 1), share * (1.0 - t.x) * t.y);
  mab_add(sum, level, texel + ivec2(1, 1), share * t.x * t.y);
#else
  const vec4 across = mab_catmull_rom(t.x);
  const vec4 down = mab_catmull_rom(t.y);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) mab_add(sum, level, texel + ivec2(x, y) - 1, share * across[x] * down[y]);
#endif
}

// The ray of the nearest texel of the level with the largest share.
uint brace_layer_ray(uvec2 pixel) {
  const MabPlace place = mab_place(pixel);
  uint largest = place.first;
  float most = -1.0;
  for (uint level = place.first; level <= place.last; ++level) {
    const float share = mab_share(level, place);
    if (share > most) {
      most = share;
      largest = level;
    }
  }
  const uvec2 size = brace_mab.level[largest].xy;
  const uvec2 at = min(uvec2((vec2(pixel) + 0.5) * (vec2(size) / vec2(brace_eye.grid.zw))), size - 1u);
  return brace_mab_ray_of_texel[brace_mab.level[largest].z + at.y * size.x + at.x];
}

// The picture is the levels' mean by share; the depth that of the rays that hit, where they are half or more.
void brace_close(uvec2 pixel, out vec4 colour, out float depth_m) {
  const MabPlace place = mab_place(pixel);
  MabSum sum = MabSum(vec4(0.0), 0.0, 0.0);
  for (uint level = place.first; level <= place.last; ++level) {
    const float share = mab_share(level, place);
    if (share > 0.0) mab_add_level(sum, level, pixel, share);
  }
  // A cubic overshoots; what it is put together from does not.
  const float opacity = clamp(sum.colour.a, 0.0, 1.0);
  colour = vec4(clamp(sum.colour.rgb, vec3(0.0), vec3(opacity)), opacity);
  depth_m = sum.hit_share >= 0.5 ? sum.hit_depth_m / sum.hit_share : BRACE_NO_HIT;
}
#endif
