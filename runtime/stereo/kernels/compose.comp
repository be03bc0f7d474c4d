#version 460
// The second eye's picture from the layers (Buchacher, Algorithm 3): a pixel blends, from front to back, what the
// rays left there that can fall on it: those from the entry ray, which meets the pixel at the volume's nearest
// depth, down to the one that meets it at the farthest. Where the rows of both eyes lie between each other, the
// two rows around are composed and interpolated.
#include "brace/frame.glsl"
#include "stage/parameters.glsl"
#include "layers_store.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, set = 0, binding = BRACE_SLOT_EYE_IMAGE) buffer BraceEyeImage { uint brace_eye_image[]; };
layout(std430, set = 0, binding = BRACE_SLOT_EYE_DEPTH) buffer BraceEyeDepth { float brace_eye_depth_m[]; };

const float opaque = 0.999;  // what is behind adds less than a quarter of a level

int ray_at(float column, float depth) {
  const float rays = (column - stereo.line.y + stereo.line.z / depth) / stereo.line.x - 0.5;
  return int(floor(clamp(rays, -1e6, 1e6))) + stereo.grid.x;
}

// `depth`: along the view direction, of the first piece that shows.
vec4 compose_row(int x, int row, out float depth) {
  const int entry = min(ray_at(float(x) + 1.0, stereo.depths.x) + 1, stereo.grid.z - 1);
  const int exit = max(ray_at(float(x), stereo.depths.y), 0);
  vec4 colour = vec4(0.0);
  depth = BRACE_NO_HIT;
  for (int ray = entry; ray >= exit; --ray) {
    const uvec2 range = stereo_ranges[row * stereo.grid.z + ray];
    if (range.y != stereo.layers.y || x < int(range.x & 0xffffu) || x >= int(range.x >> 16)) continue;
    const vec4 piece = stereo_load(stereo_row_of(uvec2(ray, row)) + uint(x));
    if (colour.w == 0.0 && piece.w > 0.0) {
      const float line = stereo.line.x * (float(ray - stereo.grid.x) + 0.5) + stereo.line.y;
      const float beside = max(line - (float(x) + 0.5), 1e-6);
      depth = clamp(stereo.line.z / beside, stereo.depths.x, stereo.depths.y);
    }
    colour += (1.0 - colour.w) * piece;
    if (colour.w >= opaque) break;
  }
  return colour;
}

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, stereo.layers.zw))) return;
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  const float row = stereo.rows.x * (float(pixel.y) + 0.5) + stereo.rows.y - 0.5 + float(stereo.grid.y);
  const int upper = clamp(int(floor(row + 1e-3)), 0, stereo.grid.w - 1);
  const float weight = row - float(upper);
  float depth;
  vec4 colour = compose_row(pixel.x, upper, depth);
  if (weight > 1e-3 && upper + 1 < stereo.grid.w) {
    float lower_depth;
    colour = mix(colour, compose_row(pixel.x, upper + 1, lower_depth), weight);
    depth = min(depth, lower_depth);
  }
  const vec2 tangent = stereo.tangents.xz + (vec2(pixel) + 0.5) * stereo.tangents.yw;
  const uint index = uint(pixel.y) * stereo.layers.z + uint(pixel.x);
  brace_eye_image[index] = packUnorm4x8(vec4(min(colour.xyz, colour.www), colour.w));
  brace_eye_depth_m[index] = depth * sqrt(1.0 + dot(tangent, tangent)) * brace_eye.eye.w;
}
