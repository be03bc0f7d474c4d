#version 460
// An eye's picture from that of the same eye on another plane. Directions are the same, so the one is a homography of the
// other; colours by a cubic (Catmull and Rom), which keeps edges as they are where it does not magnify.
#include "brace/plane_params.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, set = 0, binding = 0) readonly buffer BracePlaneBlock { BracePlaneParams plane; };
layout(std430, set = 0, binding = 1) readonly buffer BraceFromImage { uint from_image[]; };
layout(std430, set = 0, binding = 2) readonly buffer BraceFromDepth { float from_depth_m[]; };
layout(std430, set = 0, binding = 3) writeonly buffer BraceEyeImage { uint brace_eye_image[]; };
layout(std430, set = 0, binding = 4) writeonly buffer BraceEyeDepth { float brace_eye_depth_m[]; };

uint at(ivec2 pixel) {
  const ivec2 inside = clamp(pixel, ivec2(0), ivec2(plane.sizes.xy) - 1);
  return uint(inside.y) * plane.sizes.x + uint(inside.x);
}

vec4 catmull_rom(float t) {
  return vec4(t * (-0.5 + t * (1.0 - 0.5 * t)), 1.0 + t * t * (1.5 * t - 2.5), t * (0.5 + t * (2.0 - 1.5 * t)),
              t * t * (0.5 * t - 0.5));
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, plane.sizes.zw))) return;
  const vec2 middle = vec2(pixel) + 0.5;
  const vec3 direction = plane.base.xyz + middle.x * plane.across.xyz + middle.y * plane.down.xyz;
  const vec2 place = (direction.xy / -direction.z - plane.place.xy) * plane.place.zw;
  const vec2 low = floor(place - 0.5);
  const vec4 across = catmull_rom(place.x - 0.5 - low.x), down = catmull_rom(place.y - 0.5 - low.y);
  vec4 sum = vec4(0.0);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      sum += across[x] * down[y] * unpackUnorm4x8(from_image[at(ivec2(low) + ivec2(x, y) - 1)]);
  // A cubic overshoots; what it is put together from does not.
  const float opacity = clamp(sum.a, 0.0, 1.0);
  const uint index = pixel.y * plane.sizes.z + pixel.x;
  brace_eye_image[index] = packUnorm4x8(vec4(clamp(sum.rgb, vec3(0.0), vec3(opacity)), opacity));
  brace_eye_depth_m[index] = from_depth_m[at(ivec2(floor(place)))];
}
