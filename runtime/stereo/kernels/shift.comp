#version 460
// The second eye's picture where the volume's disparity varies by less than a pixel: the first eye's rays,
// shifted. Which ray: the one that meets the pixel's middle halfway, in disparity, through the volume. From the middle both
// eyes' pictures are made so; brace_area.origin.x says which.
#include "brace/ray_buffers.glsl"
#include "brace/stereo_params.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, set = 0, binding = 16) readonly buffer BraceStereoBlock { BraceStereoParams stereo_pictures[]; };
#define stereo stereo_pictures[brace_area.origin.x]
layout(std430, set = 0, binding = BRACE_SLOT_EYE_IMAGE) buffer BraceEyeImage { uint brace_eye_image[]; };
layout(std430, set = 0, binding = BRACE_SLOT_EYE_DEPTH) buffer BraceEyeDepth { float brace_eye_depth_m[]; };

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, stereo.layers.zw))) return;
  vec2 middle = vec2(gl_GlobalInvocationID.xy) + 0.5;
  if (stereo.first.z != 0u) middle.x = float(stereo.layers.z) - middle.x;
  const float disparity = 0.5 * stereo.line.z * (1.0 / stereo.depths.x + 1.0 / stereo.depths.y);
  const vec2 at = vec2((middle.x - stereo.line.y + disparity) / stereo.line.x,
                       stereo.rows.x * middle.y + stereo.rows.y);
  const ivec2 cell = ivec2(floor(at)) + stereo.grid.xy;
  const uint index = gl_GlobalInvocationID.y * stereo.layers.z + gl_GlobalInvocationID.x;
  const bool inside = all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, stereo.grid.zw));
  const int column = stereo.first.z != 0u ? stereo.grid.z - 1 - cell.x : cell.x;
  const uint ray = inside ? uint(cell.y * stereo.grid.z + column) : 0u;
  brace_eye_image[index] = packUnorm4x8(inside ? brace_result_colours[ray] : vec4(0.0));
  brace_eye_depth_m[index] = inside ? brace_result_depths_m[ray] : BRACE_NO_HIT;
}
