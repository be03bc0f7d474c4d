#version 460
// Closing brace: the picture of one eye from the results of its rays. The rays stage gives
//   void brace_close(uvec2 pixel, out vec4 colour, out float depth_m)
// and, where its rays are not the pixels, for warps that take layers (BRACE_LAYERS_BY_RAY)
//   uint brace_layer_ray(uvec2 pixel)   the ray whose layers stand for the pixel
#define BRACE_KERNEL_CLOSING
#include "brace/ray_buffers.glsl"
#include "stage/parameters.glsl"
#include "stage/rays.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Premultiplied RGBA8, r in the lowest byte.
layout(std430, set = 0, binding = BRACE_SLOT_EYE_IMAGE) buffer BraceEyeImage { uint brace_eye_image[]; };
// Metres from the eye, or BRACE_NO_HIT.
layout(std430, set = 0, binding = BRACE_SLOT_EYE_DEPTH) buffer BraceEyeDepth { float brace_eye_depth_m[]; };

#if defined(BRACE_LAYERS_BY_RAY)
layout(std430, set = 0, binding = 33) buffer BraceLayerRays { uint brace_layer_ray_of_pixel[]; };
#endif

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, brace_area.size))) return;
  const uvec2 pixel = brace_area.origin + gl_GlobalInvocationID.xy;
  const uint index = pixel.y * brace_eye.grid.z + pixel.x;
  vec4 colour;
  float depth_m;
  brace_close(pixel, colour, depth_m);
  brace_eye_image[index] = packUnorm4x8(colour);
  brace_eye_depth_m[index] = depth_m;
#if defined(BRACE_LAYERS_BY_RAY)
  brace_layer_ray_of_pixel[index] = brace_layer_ray(pixel);
#endif
}
