#version 460
// Fresh rays for the pixels of a composed picture that are not known to the end. Before the cast (BRACE_HOLES_MASK) it takes
// the rays of all others away, behind it it puts what the fresh ones saw into the picture; or, of an atlas
// (BRACE_HOLES_OF_ATLAS), what was composed for all others into the rays' results.
#include "brace/ray_buffers.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, set = 0, binding = 34) readonly buffer NovelHoles { uint novel_holes[]; };
#if defined(BRACE_HOLES_MASK)
#elif defined(BRACE_HOLES_OF_ATLAS)
layout(std430, set = 0, binding = 35) readonly buffer ComposedColours { vec4 composed_colours[]; };
layout(std430, set = 0, binding = 36) readonly buffer ComposedDepths { float composed_depths_m[]; };
#else
layout(std430, set = 0, binding = BRACE_SLOT_EYE_IMAGE) buffer BraceEyeImage { uint brace_eye_image[]; };
layout(std430, set = 0, binding = BRACE_SLOT_EYE_DEPTH) buffer BraceEyeDepth { float brace_eye_depth_m[]; };
#endif

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, brace_area.size))) return;
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  const uint ray = brace_ray_index(pixel);
#if defined(BRACE_HOLES_OF_ATLAS)
  const uint index = ray;
#else
  const uint index = pixel.y * brace_eye.grid.z + pixel.x;
#endif
  const bool is_fresh = novel_holes[index] != 0u;
#if defined(BRACE_HOLES_MASK)
  if (!is_fresh) brace_ray_entries[ray].w = 0.0;
#elif defined(BRACE_HOLES_OF_ATLAS)
  if (is_fresh) return;
  brace_result_colours[ray] = composed_colours[index];
  brace_result_depths_m[ray] = composed_depths_m[index];
#else
  if (!is_fresh) return;
  brace_eye_image[index] = packUnorm4x8(brace_result_colours[ray]);
  brace_eye_depth_m[index] = brace_result_depths_m[ray];
#endif
}
