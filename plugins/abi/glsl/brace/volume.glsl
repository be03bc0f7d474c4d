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

// What lies around a point, fetched and not interpolated yet. It may be asked, cheaply, whether all of it is
// below what the transfer function shows.
struct BraceCell {
#if defined(BRACE_VOLUME_PACKED_8)
  uvec2 texels;  // slices z and z + 1
  vec3 place;    // of the point in its cell of 2 x 2 x 2 voxels, 0 … 1
#elif defined(BRACE_VOLUME_PACKED_16)
  uvec4 texels;  // (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1)
  vec3 place;
#else
  float value;
#endif
};

#if defined(BRACE_VOLUME_PACKED_8) || defined(BRACE_VOLUME_PACKED_16) || defined(BRACE_VOLUME_TEXELS_32)
// The first texel of a point's cell, and the point's place in it.
int brace_cell_at(vec3 voxel, out vec3 place) {
  const vec3 shifted = voxel + 0.5;  // the apron moves voxel i from centre i + 0.5 to i + 1
  const ivec3 cell = ivec3(shifted);
  place = shifted - vec3(cell);
  return cell.z * int(brace_eye.texel_grid.y) + cell.y * int(brace_eye.texel_grid.x) + cell.x;
}
#endif

// `voxel` is known to lie in the box [0, dims], give or take 0.25 voxels.
BraceCell brace_fetch(vec3 voxel) {
  BraceCell cell;
#if defined(BRACE_VOLUME_PACKED_8)
  const int at = brace_cell_at(voxel, cell.place);
  cell.texels.x = texelFetch(brace_voxels, at).x;
  cell.texels.y = texelFetch(brace_voxels, at + int(brace_eye.texel_grid.y)).x;
#elif defined(BRACE_VOLUME_PACKED_16)
  const int at = brace_cell_at(voxel, cell.place);
  const int row = int(brace_eye.texel_grid.x);
  const int slice = int(brace_eye.texel_grid.y);
  cell.texels = uvec4(texelFetch(brace_voxels, at).x, texelFetch(brace_voxels, at + row).x,
                      texelFetch(brace_voxels, at + slice).x, texelFetch(brace_voxels, at + slice + row).x);
#elif defined(BRACE_VOLUME_TEXELS_32)
  vec3 place;
  const int at = brace_cell_at(voxel, place);
  const int row = int(brace_eye.texel_grid.x);
  const int slice = int(brace_eye.texel_grid.y);
  const vec4 left = vec4(texelFetch(brace_voxels, at).x, texelFetch(brace_voxels, at + row).x,
                         texelFetch(brace_voxels, at + slice).x, texelFetch(brace_voxels, at + slice + row).x);
  const vec4 right = vec4(texelFetch(brace_voxels, at + 1).x, texelFetch(brace_voxels, at + row + 1).x,
                          texelFetch(brace_voxels, at + slice + 1).x, texelFetch(brace_voxels, at + slice + row + 1).x);
  const vec4 across_x = left + place.x * (right - left);
  const vec2 across_y = across_x.xz + place.y * (across_x.yw - across_x.xz);
  cell.value = across_y.x + place.z * (across_y.y - across_y.x);
#else
  cell.value = textureLod(brace_voxels, voxel / brace_eye.volume_dims.xyz, 0.0).x * brace_eye.value.x + brace_eye.value.y;
#endif
  return cell;
}

// The trilinear value.
float brace_value(BraceCell cell) {
#if defined(BRACE_VOLUME_PACKED_8)
  const vec4 near = vec4(cell.texels.xxxx >> uvec4(0, 8, 16, 24) & 255u);
  const vec4 far = vec4(cell.texels.yyyy >> uvec4(0, 8, 16, 24) & 255u);
  const vec4 across_z = near + cell.place.z * (far - near);
  const vec2 across_y = across_z.xy + cell.place.y * (across_z.zw - across_z.xy);
  return across_y.x + cell.place.x * (across_y.y - across_y.x);
#elif defined(BRACE_VOLUME_PACKED_16)
  const vec4 left = vec4(cell.texels & 65535u);
  const vec4 across_x = left + cell.place.x * (vec4(cell.texels >> 16) - left);
  const vec2 across_y = across_x.xz + cell.place.y * (across_x.yw - across_x.xz);
  return across_y.x + cell.place.z * (across_y.y - across_y.x) + brace_eye.value.y;
#else
  return cell.value;
#endif
}

// Whether the transfer function shows nothing of a cell because all of it is too low. Never true by mistake;
// true less often where only a coarser test pays.
bool brace_is_empty(BraceCell cell) {
#if defined(BRACE_VOLUME_PACKED_8)
  // Per byte: does it exceed the threshold? The sum's top bit says so for the lower seven bits.
  const uvec2 sum = (cell.texels & 0x7f7f7f7fu) + brace_eye.texel_grid.z;
  const uvec2 over = (sum & cell.texels) | ((sum | cell.texels) & brace_eye.texel_grid.w);
  return ((over.x | over.y) & 0x80808080u) == 0u;
#else
  return brace_value(cell) * brace_eye.transfer.x + brace_eye.transfer.y <= brace_eye.transfer.w;
#endif
}

// The value at any point; beyond the box, that of the nearest point of its edge.
float brace_volume(vec3 voxel) {
  return brace_value(brace_fetch(clamp(voxel, vec3(0.0), brace_eye.volume_dims.xyz)));
}

#endif
