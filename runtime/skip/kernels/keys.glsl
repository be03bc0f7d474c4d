// Keys of voxels: unsigned integers in the order of the values. 8-bit: the voxel; 16-bit: the voxel, int16 plus
// 32768; float: the upper half of the ordered bit pattern. The voxels lie as VolumeOnDevice defines it.
#ifndef BRACE_SKIP_KEYS_GLSL
#define BRACE_SKIP_KEYS_GLSL

#include "build_params.h"

layout(std140, binding = BRACE_SKIP_SLOT_PARAMS) uniform BuildBlock { SkipBuildParams build; };

#if defined(BRACE_VOLUME_PACKED_8) || defined(BRACE_VOLUME_PACKED_16)
layout(binding = BRACE_SKIP_SLOT_VOLUME) uniform usamplerBuffer voxels;
#elif defined(BRACE_VOLUME_TEXELS_32)
layout(binding = BRACE_SKIP_SLOT_VOLUME) uniform samplerBuffer voxels;
#else
layout(binding = BRACE_SKIP_SLOT_VOLUME) uniform sampler3D voxels;
#endif

// Smallest and largest key. A range that knows no bounds (NaN, infinity) is the widest.
struct KeyRange {
  uint low;
  uint high;
};

KeyRange merged(KeyRange a, KeyRange b) { return KeyRange(min(a.low, b.low), max(a.high, b.high)); }

KeyRange float_range(float value) {
  const uint bits = floatBitsToUint(value);
  const uint ordered = (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
  const bool finite = (bits & 0x7f800000u) != 0x7f800000u;
  return KeyRange(finite ? ordered >> 16 : 0u, finite ? ordered >> 16 : 65535u);
}

// The 2 x 2 voxels of slice z, clamped to the edge, whose lower corner is `corner`, -1 ... dims - 1.
KeyRange face_range(ivec2 corner, int z) {
#if defined(BRACE_VOLUME_PACKED_8) || defined(BRACE_VOLUME_PACKED_16) || defined(BRACE_VOLUME_TEXELS_32)
  const int row = int(build.texel_grid.x);
  const int at = (z + 1) * int(build.texel_grid.y) + (corner.y + 1) * row + corner.x + 1;
#endif
#if defined(BRACE_VOLUME_PACKED_8)
  const uint texel = texelFetch(voxels, at).x;
  const uvec4 keys = uvec4(texel & 255u, (texel >> 8) & 255u, (texel >> 16) & 255u, texel >> 24);
  return KeyRange(min(min(keys.x, keys.y), min(keys.z, keys.w)), max(max(keys.x, keys.y), max(keys.z, keys.w)));
#elif defined(BRACE_VOLUME_PACKED_16)
  const uint near = texelFetch(voxels, at).x;
  const uint far = texelFetch(voxels, at + row).x;
  const uvec4 keys = uvec4(near & 65535u, near >> 16, far & 65535u, far >> 16);
  return KeyRange(min(min(keys.x, keys.y), min(keys.z, keys.w)), max(max(keys.x, keys.y), max(keys.z, keys.w)));
#elif defined(BRACE_VOLUME_TEXELS_32)
  return merged(merged(float_range(texelFetch(voxels, at).x), float_range(texelFetch(voxels, at + 1).x)),
                merged(float_range(texelFetch(voxels, at + row).x), float_range(texelFetch(voxels, at + row + 1).x)));
#else
  const ivec3 last = ivec3(build.dims.xyz) - 1;
  const ivec3 low = clamp(ivec3(corner, z), ivec3(0), last);
  const ivec3 high = clamp(ivec3(corner + 1, z), ivec3(0), last);
  const vec4 values = vec4(texelFetch(voxels, low, 0).x, texelFetch(voxels, ivec3(high.x, low.yz), 0).x,
                           texelFetch(voxels, ivec3(low.x, high.y, low.z), 0).x, texelFetch(voxels, high, 0).x);
#if defined(BRACE_SKIP_FLOAT)
  return merged(merged(float_range(values.x), float_range(values.y)),
                merged(float_range(values.z), float_range(values.w)));
#else
  const float least = min(min(values.x, values.y), min(values.z, values.w));
  const float most = max(max(values.x, values.y), max(values.z, values.w));
  const float full_scale = float(build.dims.w);
  return KeyRange(uint(least * full_scale + 0.5), uint(most * full_scale + 0.5));
#endif
#endif
}

// One voxel inside the volume.
KeyRange voxel_range(ivec3 voxel) {
#if defined(BRACE_VOLUME_PACKED_8) || defined(BRACE_VOLUME_PACKED_16) || defined(BRACE_VOLUME_TEXELS_32)
  const int at = (voxel.z + 1) * int(build.texel_grid.y) + (voxel.y + 1) * int(build.texel_grid.x) + voxel.x + 1;
#endif
#if defined(BRACE_VOLUME_PACKED_8)
  const uint key = texelFetch(voxels, at).x & 255u;
#elif defined(BRACE_VOLUME_PACKED_16)
  const uint key = texelFetch(voxels, at).x & 65535u;
#elif defined(BRACE_VOLUME_TEXELS_32)
  return float_range(texelFetch(voxels, at).x);
#elif defined(BRACE_SKIP_FLOAT)
  return float_range(texelFetch(voxels, voxel, 0).x);
#else
  const uint key = uint(texelFetch(voxels, voxel, 0).x * float(build.dims.w) + 0.5);
#endif
#if !defined(BRACE_VOLUME_TEXELS_32) && !defined(BRACE_SKIP_FLOAT)
  return KeyRange(key, key);
#endif
}

#endif
