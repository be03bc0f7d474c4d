#version 460
// Fresh rays for the pixels of a novel view that are not known to the end. Before the cast (BRACE_HOLES_MASK) it takes
// the rays of all others away, behind it it puts what the fresh ones saw into the picture.
#include "brace/ray_buffers.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, set = 0, binding = 34) readonly buffer NovelHoles { uint novel_holes[]; };
#if !defined(BRACE_HOLES_MASK)
layout(std430, set = 0, binding = BRACE_SLOT_EYE_IMAGE) buffer BraceEyeImage { uint brace_eye_image[]; };
layout(std430, set = 0, binding = BRACE_SLOT_EYE_DEPTH) buffer BraceEyeDepth { float brace_eye_depth_m[]; };
#endif

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, brace_area.size))) return;
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  const uint index = pixel.y * brace_eye.grid.z + pixel.x;
  const uint ray = brace_ray_index(pixel);
#if defined(BRACE_HOLES_MASK)
  if (novel_holes[index] == 0u) brace_ray_entries[ray].w = 0.0;
#else
  if (novel_holes[index] == 0u) return;
  brace_eye_image[index] = packUnorm4x8(brace_result_colours[ray]);
  brace_eye_depth_m[index] = brace_result_depths_m[ray];
#endif
}
