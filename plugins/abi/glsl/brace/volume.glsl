// Access to the volume's values, trilinear between voxel centres, clamped to the edge. Values are in the
// data's own units. How the voxels lie in memory is chosen per device and defined by the host:
//   BRACE_VOLUME_PACKED_8   texel (x, y, z) of a R32UI buffer holds the 2 x 2 voxels around it in x and y
//   BRACE_VOLUME_PACKED_16  texel of a R32UI buffer holds 2 voxels along x
//   BRACE_VOLUME_TEXELS_32  texel of a R32F buffer holds one voxel
//   none of them            a 3D sampler
// The buffers have an apron of edge voxels, so that a point inside the box never needs a clamped index.
#ifndef BRACE_VOLUME_GLSL
#define BRACE_VOLUME_GLSL

#include "brace/frame.glsl"

#if defined(BRACE_VOLUME_PACKED_8) || defined(BRACE_VOLUME_PACKED_16)
layout(set = 0, binding = BRACE_SLOT_VOLUME) uniform usamplerBuffer brace_voxels;
#elif defined(BRACE_VOLUME_TEXELS_32)
layout(set = 0, binding = BRACE_SLOT_VOLUME) uniform samplerBuffer brace_voxels;
#else
layout(set = 0, binding = BRACE_SLOT_VOLUME) uniform sampler3D brace_voxels;
#endif

#if defined(BRACE_VOLUME_PACKED_8) || defined(BRACE_VOLUME_PACKED_16) || defined(BRACE_VOLUME_TEXELS_32)
// The cell of a point: its first texel, and the point's place in it, 0 … 1.
int brace_cell(vec3 voxel, out vec3 place) {
  const vec3 shifted = voxel + 0.5;  // the apron moves voxel i from centre i + 0.5 to i + 1
  const ivec3 cell = ivec3(shifted);
  place = shifted - vec3(cell);
  return cell.z * int(brace_eye.texel_grid.y) + cell.y * int(brace_eye.texel_grid.x) + cell.x;
}
#endif

// The value at a point known to lie in the box [0, dims], give or take 0.25 voxels.
float brace_volume_inside(vec3 voxel) {
#if defined(BRACE_VOLUME_PACKED_8)
  vec3 place;
  const int at = brace_cell(voxel, place);
  const uint near = texelFetch(brace_voxels, at).x;
  const uint far = texelFetch(brace_voxels, at + int(brace_eye.texel_grid.y)).x;
  const vec4 a = vec4(float(near & 255u), float((near >> 8) & 255u), float((near >> 16) & 255u), float(near >> 24));
  const vec4 b = vec4(float(far & 255u), float((far >> 8) & 255u), float((far >> 16) & 255u), float(far >> 24));
  const vec4 across_z = a + place.z * (b - a);
  const vec2 across_y = across_z.xy + place.y * (across_z.zw - across_z.xy);
  return across_y.x + place.x * (across_y.y - across_y.x);
#elif defined(BRACE_VOLUME_PACKED_16)
  vec3 place;
  const int at = brace_cell(voxel, place);
  const int row = int(brace_eye.texel_grid.x);
  const int slice = int(brace_eye.texel_grid.y);
  const uvec4 texels = uvec4(texelFetch(brace_voxels, at).x, texelFetch(brace_voxels, at + row).x,
                             texelFetch(brace_voxels, at + slice).x, texelFetch(brace_voxels, at + slice + row).x);
  const vec4 left = vec4(texels & 65535u);
  const vec4 across_x = left + place.x * (vec4(texels >> 16) - left);
  const vec2 across_y = across_x.xz + place.y * (across_x.yw - across_x.xz);
  const float raw = across_y.x + place.z * (across_y.y - across_y.x);
  return raw + brace_eye.value.y;
#elif defined(BRACE_VOLUME_TEXELS_32)
  vec3 place;
  const int at = brace_cell(voxel, place);
  const int row = int(brace_eye.texel_grid.x);
  const int slice = int(brace_eye.texel_grid.y);
  const vec4 left = vec4(texelFetch(brace_voxels, at).x, texelFetch(brace_voxels, at + row).x,
                         texelFetch(brace_voxels, at + slice).x, texelFetch(brace_voxels, at + slice + row).x);
  const vec4 right = vec4(texelFetch(brace_voxels, at + 1).x, texelFetch(brace_voxels, at + row + 1).x,
                          texelFetch(brace_voxels, at + slice + 1).x, texelFetch(brace_voxels, at + slice + row + 1).x);
  const vec4 across_x = left + place.x * (right - left);
  const vec2 across_y = across_x.xz + place.y * (across_x.yw - across_x.xz);
  return across_y.x + place.z * (across_y.y - across_y.x);
#else
  return textureLod(brace_voxels, voxel / brace_eye.volume_dims.xyz, 0.0).x * brace_eye.value.x + brace_eye.value.y;
#endif
}

// The value at any point; beyond the box, that of the nearest point of its edge.
float brace_volume(vec3 voxel) {
  return brace_volume_inside(clamp(voxel, vec3(0.0), brace_eye.volume_dims.xyz));
}

#endif
