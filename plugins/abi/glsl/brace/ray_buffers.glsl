// The ray buffers and result buffers themselves, indexed by ray; used by the kernels and closing braces.
#ifndef BRACE_RAY_BUFFERS_GLSL
#define BRACE_RAY_BUFFERS_GLSL

#include "brace/ray.glsl"

layout(std430, set = 0, binding = BRACE_SLOT_RAY_ENTRY) buffer BraceRayEntries { vec4 brace_ray_entries[]; };
layout(std430, set = 0, binding = BRACE_SLOT_RAY_DIRECTION) buffer BraceRayDirections { vec4 brace_ray_directions[]; };
layout(std430, set = 0, binding = BRACE_SLOT_RESULT_COLOUR) buffer BraceColours { vec4 brace_result_colours[]; };
// Metres from the eye to the first visible sample, or BRACE_NO_HIT.
layout(std430, set = 0, binding = BRACE_SLOT_RESULT_DEPTH) buffer BraceDepths { float brace_result_depths_m[]; };

uint brace_ray_index(uvec2 cell) { return cell.y * brace_eye.grid.x + cell.x; }

BraceRay brace_load_ray(uint index) {
  const vec4 entry = brace_ray_entries[index];
  const vec4 direction = brace_ray_directions[index];
  return BraceRay(entry.xyz, entry.w, direction.xyz, direction.w);
}

void brace_store_ray(uint index, BraceRay ray) {
  brace_ray_entries[index] = vec4(ray.entry, ray.extent);
  brace_ray_directions[index] = vec4(ray.direction, ray.level);
}

#endif
