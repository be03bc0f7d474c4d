// Coarser levels of the volume: level l has about 2^l voxels of the volume along the edge of one of its own, their
// mean. There where the host defines BRACE_VOLUME_LEVELS and, by the voxels' type, BRACE_LEVELS_8, _16 or _32.
#ifndef BRACE_LEVELS_GLSL
#define BRACE_LEVELS_GLSL

#include "brace/level_params.h"
#include "brace/volume.glsl"

#define BRACE_SLOT_LEVEL_VOXELS 42  // texel buffer: levels 1 … last, each packed as brace/volume.glsl says
#define BRACE_SLOT_LEVEL_TABLE 43   // storage: BraceLevelTable

#if defined(BRACE_LEVELS_32)
layout(set = 0, binding = BRACE_SLOT_LEVEL_VOXELS) uniform samplerBuffer brace_level_voxels;
#else
layout(set = 0, binding = BRACE_SLOT_LEVEL_VOXELS) uniform usamplerBuffer brace_level_voxels;
#endif
layout(std430, set = 0, binding = BRACE_SLOT_LEVEL_TABLE) readonly buffer BraceLevelBlock { BraceLevelTable brace_level; };

int brace_level_last() { return int(brace_level.last.x); }

// The trilinear value in a level from 1 to the last; `voxel` as for brace_fetch, in voxels of the volume.
float brace_level_value(vec3 voxel, int level) {
  const uvec4 where = brace_level.levels[level].place;
  const int row = int(where.y);
  const int slice = int(where.z);
  const vec3 shifted = voxel * brace_level.levels[level].scale.xyz + 0.5;
  const ivec3 cell = ivec3(shifted);
  const vec3 place = shifted - vec3(cell);
  const int at = int(where.x) + cell.z * slice + cell.y * row + cell.x;
#if defined(BRACE_LEVELS_8)
  const uint front = texelFetch(brace_level_voxels, at).x;
  const uint back = texelFetch(brace_level_voxels, at + slice).x;
  const vec4 near = vec4(uvec4(front) >> uvec4(0, 8, 16, 24) & 255u);
  const vec4 far = vec4(uvec4(back) >> uvec4(0, 8, 16, 24) & 255u);
  const vec4 across_z = near + place.z * (far - near);
  const vec2 across_y = across_z.xy + place.y * (across_z.zw - across_z.xy);
  return across_y.x + place.x * (across_y.y - across_y.x);
#elif defined(BRACE_LEVELS_16)
  const uvec4 texels = uvec4(texelFetch(brace_level_voxels, at).x, texelFetch(brace_level_voxels, at + row).x,
                             texelFetch(brace_level_voxels, at + slice).x,
                             texelFetch(brace_level_voxels, at + slice + row).x);
  const vec4 left = vec4(texels & 65535u);
  const vec4 across_x = left + place.x * (vec4(texels >> 16) - left);
  const vec2 across_y = across_x.xz + place.y * (across_x.yw - across_x.xz);
  return across_y.x + place.z * (across_y.y - across_y.x) + brace_eye.value.y;
#else
  const vec4 left = vec4(texelFetch(brace_level_voxels, at).x, texelFetch(brace_level_voxels, at + row).x,
                         texelFetch(brace_level_voxels, at + slice).x,
                         texelFetch(brace_level_voxels, at + slice + row).x);
  const vec4 right = vec4(texelFetch(brace_level_voxels, at + 1).x, texelFetch(brace_level_voxels, at + row + 1).x,
                          texelFetch(brace_level_voxels, at + slice + 1).x,
                          texelFetch(brace_level_voxels, at + slice + row + 1).x);
  const vec4 across_x = left + place.x * (right - left);
  const vec2 across_y = across_x.xz + place.y * (across_x.yw - across_x.xz);
  return across_y.x + place.z * (across_y.y - across_y.x);
#endif
}

#endif
