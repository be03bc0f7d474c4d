#version 460
// The second eye's picture from the layers (Buchacher, Algorithm 3): a pixel blends, from front to back, what the
// rays left there that can fall on it: those from the entry ray, which meets the pixel at the volume's nearest
// depth, down to the one that meets it at the farthest. Where the rows of both eyes lie between each other, the
// two rows around are composed and interpolated.
//
// Linear interpolation (He and Kaufman 1996): at every depth the pixel's middle lies between two rays, and optical depths
// are weighted by how near each is. Columns are half a pixel wide, so that pieces of both rays at the same depth are
// told from those before and behind.
//
// With rays/mab (BRACE_STEREO_BY_TEXEL) what is composed are the texels of the eye's own atlas, each from the rays of its
// level; of rays that were not cast nothing is known.
#include "brace/frame.glsl"
#include "stage/parameters.glsl"
#if !defined(BRACE_STEREO_REFERENCE_MIDDLE)
#define BRACE_STEREO_REFERENCE_MIDDLE  // which picture it is comes with the dispatch
#endif
#include "layers_store.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

#if defined(BRACE_STEREO_BY_TEXEL)
layout(std430, set = 0, binding = 21) writeonly buffer BraceStereoColours { vec4 stereo_colours[]; };
layout(std430, set = 0, binding = 22) writeonly buffer BraceStereoDepths { float stereo_depths_m[]; };
layout(std430, set = 0, binding = 25) readonly buffer BraceMabTexels { uint stereo_texel_of_ray[]; };
#else
layout(std430, set = 0, binding = BRACE_SLOT_EYE_IMAGE) buffer BraceEyeImage { uint brace_eye_image[]; };
layout(std430, set = 0, binding = BRACE_SLOT_EYE_DEPTH) buffer BraceEyeDepth { float brace_eye_depth_m[]; };
#endif
#if defined(BRACE_STEREO_HOLES_FRESH_RAYS)
// Per pixel, or per ray of an atlas: 1 where what it shows is not known to the end.
layout(std430, set = 0, binding = 20) writeonly buffer BraceStereoHoles { uint stereo_unknown[]; };
#endif

const float opaque = 0.999;    // what is behind adds less than a quarter of a level
const float hole_left = 0.05;  // an unknown part that is seen through less does not matter

struct Composed {
  vec4 colour;
  float depth;  // along the view direction, of the first piece that shows
  bool unknown, hole;
};

uint texels_read = 0u;

// What a ray left: columns first … behind - 1 of its layer; what it knows nothing of: behind - 1 (the rest of where it
// was stopped) … until - 1.
struct Left {
  int first, behind, until;
  uint at;
};

// Ray whose column of the layers at a depth is `column`, rounded down.
int ray_at(float column, float depth, int row) {
  const float beside = column - stereo.columns.x * float(stereo_phase(uint(row))) - stereo.line.y;
  const float rays = (beside + stereo.line.z / depth) / stereo.line.x - 0.5;
  return int(floor(clamp(rays, -1e6, 1e6))) + stereo.grid.x;
}

// Of a ray that was not cast: with rays/mab nothing is known of the columns that the volume can fall on; else it lies
// beside all that can be seen, or misses the volume.
Left not_cast(int ray, int row) {
#if defined(BRACE_STEREO_BY_TEXEL)
  const float line = stereo_line_of(ray, uint(max(row, 0)));
  const int low = int(floor(line - stereo.line.z / stereo.depths.x));
  return Left(0x7fffffff, low + 1, int(floor(line - stereo.line.z / stereo.depths.y)) + 1, 0u);
#else
  return Left(0x7fffffff, 0, 0, 0u);
#endif
}

Left left_by(int ray, int row) {
  if (ray < 0 || ray >= stereo.grid.z || row < 0 || row >= stereo.grid.w) return not_cast(ray, row);
  const uvec2 range = stereo_ranges[stereo_range_of(uvec2(ray, row))];
  if ((range.y & 0xffffu) != stereo.layers.y) return not_cast(ray, row);
  return Left(int(range.x & 0xffffu), int(range.x >> 16), int(range.y >> 16), stereo_row_of(uvec2(ray, row)));
}

vec4 piece_of(Left left, int column, inout Composed sum) {
  if (column >= left.behind - 1 && column < left.until) sum.unknown = true;
  if (column < left.first || column >= left.behind) return vec4(0.0);
  ++texels_read;
  return stereo_load(left.at + uint(column));
}

void blend(inout Composed sum, vec4 piece, int ray, int row, float column) {
  if (sum.colour.w == 0.0 && piece.w > 0.0) {
    const float beside = max(stereo_line_of(ray, uint(row)) - column, 1e-6);
    sum.depth = clamp(stereo.line.z / beside, stereo.depths.x, stereo.depths.y);
  }
  sum.colour += (1.0 - sum.colour.w) * piece;
  if (sum.unknown && sum.colour.w < 1.0 - hole_left) sum.hole = true;
}

#if defined(BRACE_STEREO_BY_TEXEL)
// Rays that were not cast count wherever they would be.
int first_ray() { return -0x7fffffff; }
int last_ray() { return 0x7fffffff; }
#else
int first_ray() { return 0; }
int last_ray() { return stereo.grid.z - 1; }
#endif

#if defined(BRACE_STEREO_INTERPOLATION_LINEAR)
// Both at the same depths: optical depths add up by weight, and colours by them.
vec4 mixed(vec4 a, float weight_a, vec4 b, float weight_b) {
  const float depth_a = -weight_a * log2(max(1.0 - a.w, 1e-6)), depth_b = -weight_b * log2(max(1.0 - b.w, 1e-6));
  const float depth = depth_a + depth_b;
  if (!(depth > 0.0)) return vec4(0.0);
  const float opacity = 1.0 - exp2(-depth);
  const vec3 colour = (a.xyz * (depth_a / max(a.w, 1e-9)) + b.xyz * (depth_b / max(b.w, 1e-9))) / depth;
  return vec4(min(colour, vec3(1.0)) * opacity, opacity);
}

Composed compose_row(int x, int row) {
  Composed sum = Composed(vec4(0.0), BRACE_NO_HIT, false, false);
  const int first = 2 * x - 1;  // of the four columns whose rays are within a pixel of the middle
  const int entry = min(ray_at(float(first + 4), stereo.depths.x, row) + 1, last_ray());
  const int exit = max(ray_at(float(first), stereo.depths.y, row), first_ray());
  Left here = left_by(entry, row);
  for (int ray = entry; ray >= exit; --ray) {
    const Left next = left_by(ray - 1, row);
    for (int part = 0; part < 2; ++part) {  // passing the middle, and the next half pixel
      const vec4 ahead = piece_of(here, first + 2 + part, sum);
      const vec4 behind = piece_of(next, first + part, sum);
      const float weight = part == 0 ? 0.75 : 0.25;  // means of a tent of a pixel to each side
      blend(sum, mixed(ahead, weight, behind, 1.0 - weight), ray, row, float(first + 2 + part) + 0.5);
    }
    if (sum.colour.w >= opaque) break;
    here = next;
  }
  return sum;
}
#else
Composed compose_column(int column, int row) {
  Composed sum = Composed(vec4(0.0), BRACE_NO_HIT, false, false);
  int entry = min(ray_at(float(column) + 1.0, stereo.depths.x, row) + stereo_interleave, last_ray());
  entry -= (entry + row) % stereo_interleave;
  const int exit = max(ray_at(float(column), stereo.depths.y, row), first_ray());
  for (int ray = entry; ray >= exit; ray -= stereo_interleave) {
    blend(sum, piece_of(left_by(ray, row), column, sum), ray, row, float(column) + 0.5);
    if (sum.colour.w >= opaque) break;
  }
  return sum;
}

Composed compose_row(int x, int row) {
  if (stereo_interleave == 1) return compose_column(x, row);
  // Between the middles of two columns.
  const float at = stereo.columns.x * (float(x) + 0.5 + float(stereo_phase(uint(row)))) - 0.5;
  const int column = int(floor(at));
  Composed sum = compose_column(max(column, 0), row);
  const Composed beside = compose_column(min(column + 1, int(stereo.columns.y) - 1), row);
  sum.colour = mix(sum.colour, beside.colour, at - float(column));
  sum.depth = min(sum.depth, beside.depth);
  sum.hole = sum.hole || beside.hole;
  return sum;
}
#endif

Composed compose(ivec2 pixel) {
  const float row = stereo.rows.x * (float(pixel.y) + 0.5) + stereo.rows.y - 0.5 + float(stereo.grid.y);
  int upper = int(floor(row + 1e-3));
#if !defined(BRACE_STEREO_BY_TEXEL)
  upper = clamp(upper, 0, stereo.grid.w - 1);
#endif
  const float weight = row - float(upper);
  Composed sum = compose_row(pixel.x, upper);
  if (weight > 1e-3 && (upper + 1 < stereo.grid.w || first_ray() < 0)) {
    const Composed lower = compose_row(pixel.x, upper + 1);
    sum.colour = mix(sum.colour, lower.colour, weight);
    sum.depth = min(sum.depth, lower.depth);
    sum.hole = sum.hole || lower.hole;
  }
  sum.colour.xyz = min(sum.colour.xyz, sum.colour.www);
  const vec2 tangent = stereo.tangents.xz + (vec2(pixel) + 0.5) * stereo.tangents.yw;
  sum.depth *= sqrt(1.0 + dot(tangent, tangent)) * brace_eye.eye.w;
  return sum;
}

// brace_area: origin.x: the eye's first picture; size: of what is dispatched.
void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, brace_area.size))) return;
  uvec2 pixel = gl_GlobalInvocationID.xy;
  stereo_picture = brace_area.origin.x;
#if defined(BRACE_STEREO_BY_TEXEL)
  const uint index = pixel.y * brace_eye.grid.x + pixel.x;
  const uint texel = stereo_texel_of_ray[index];
  if (texel == 0xffffffffu) return;
  pixel = uvec2(texel & 0x3fffu, texel >> 14 & 0x3fffu);
  stereo_picture += texel >> 28;
#else
  const uint index = pixel.y * stereo.layers.z + pixel.x;
#endif
  if (stereo.first.z != 0u) pixel.x = stereo.layers.z - 1u - pixel.x;
  const Composed sum = compose(ivec2(pixel));
#if defined(BRACE_STEREO_BY_TEXEL)
  stereo_colours[index] = sum.colour;
  stereo_depths_m[index] = sum.depth;
#else
  brace_eye_image[index] = packUnorm4x8(sum.colour);
  brace_eye_depth_m[index] = sum.depth;
#endif
#if defined(BRACE_STEREO_HOLES_FRESH_RAYS)
  stereo_unknown[index] = sum.hole ? 1u : 0u;
#endif
  atomicAdd(stereo_read, texels_read);
}
