// The volume's gradient. A kernel that does not shade does not include this.
#ifndef BRACE_GRADIENT_GLSL
#define BRACE_GRADIENT_GLSL

#include "brace/volume.glsl"

#define BRACE_GRADIENT_FETCHES 6u

// Central differences over one voxel to each side, as change of value per unit of length along the volume's
// metric axes: of use for angles also where the spacing is anisotropic.
vec3 brace_gradient(vec3 voxel) {
  const vec2 h = vec2(1.0, 0.0);
  const vec3 difference = vec3(brace_volume(voxel + h.xyy) - brace_volume(voxel - h.xyy),
                               brace_volume(voxel + h.yxy) - brace_volume(voxel - h.yxy),
                               brace_volume(voxel + h.yyx) - brace_volume(voxel - h.yyx));
  return 0.5 * difference * brace_eye.voxels_per_unit.xyz;
}

#endif
