#version 460
// An eye's picture from another place, from the layers of the eye frame (Buchacher 2017, Algorithm 8; Lochmann et al.
// 2014). A new ray is walked in segments; each belongs to one pixel of the eye frame, and takes from that pixel's layers
// what their spans of distance share with its own: optical depth in proportion to the path, by Beer and Lambert.
#extension GL_EXT_control_flow_attributes : require
#include "brace/novel_view_params.h"
#include "stage/parameters.glsl"
#include "brace/layers.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, set = 0, binding = 0) readonly buffer NovelViewBlock { BraceNovelViewParams view; };
layout(std430, set = 0, binding = 1) writeonly buffer NovelImage { uint novel_image[]; };
// Metres from the new eye to the first visible segment's begin, or infinity.
layout(std430, set = 0, binding = 3) writeonly buffer NovelDepth { float novel_depth_m[]; };
#if defined(BRACE_NOVEL_HOLES)
// Per pixel: 1 where what it shows is not known to the end.
layout(std430, set = 0, binding = 4) writeonly buffer NovelHoles { uint novel_holes[]; };
#endif
// Segments walked; pixels with some beyond the old picture; pixels with some behind a ray that was stopped (what `behind`
// extends there, or what is missing).
layout(std430, set = 0, binding = 2) buffer NovelCounters { uint walked, uncovered, filled; };

#if defined(BRACE_LAYERS_BY_RAY)
layout(std430, set = 0, binding = 33) readonly buffer LayerRays { uint layer_ray_of_pixel[]; };
uint ray_of(uint pixel) { return layer_ray_of_pixel[pixel]; }
#else
uint ray_of(uint pixel) { return pixel; }
#endif

#if defined(BRACE_WARP_SCAN_OUT_LINES)
// Per pixel of the new picture: how far the scan-out is where the panel shows it.
layout(std430, set = 0, binding = 5) readonly buffer NovelScan { float novel_scan[]; };
#define OLD_FROM_NEW(i) (view.old_from_new[i].xyz + scan * (view.old_from_last[i].xyz - view.old_from_new[i].xyz))
#else
#define OLD_FROM_NEW(i) view.old_from_new[i].xyz
#endif

#define OLD_NEAR_M 1e-4      // nothing is asked of the old picture nearer to its eye's plane
#define HOLE_LEFT 0.02       // an unknown part that is seen through less does not matter
#define STOPPED_DEPTH 5.64   // a ray this deep (opacity 0.98, in powers of two) was stopped, not through

vec3 origin, direction;  // of the new ray in the old eye frame, direction of length 1

vec3 point_at(float t) { return origin + t * direction; }

// Pixel coordinates in the old picture; (0, 0) is the upper left corner.
vec2 old_pixel(vec3 p) { return (p.xy / -p.z - view.rays.xy) / view.rays.zw; }

bool inside(vec2 pixel) { return all(greaterThanEqual(pixel, vec2(0.0))) && all(lessThan(pixel, vec2(view.grid.zw))); }

// Where the ray is within the volume's box and before the old eye's plane; x >= y: nowhere.
vec2 range_in_box() {
  vec2 range = vec2(0.0, 1e30);
  [[unroll]] for (int axis = 0; axis < 3; ++axis) {
    const float at = dot(view.box_from_old[axis].xyz, origin) + view.box_from_old[axis].w;
    const float along = dot(view.box_from_old[axis].xyz, direction);
    const float inverse = 1.0 / (abs(along) > 1e-12 ? along : 1e-12);
    const float a = (-view.box_half[axis] - at) * inverse, b = (view.box_half[axis] - at) * inverse;
    range = vec2(max(range.x, min(a, b)), min(range.y, max(a, b)));
  }
  // -z >= OLD_NEAR_M
  const float ahead = -origin.z - OLD_NEAR_M;
  if (direction.z > 1e-12) range.y = min(range.y, ahead / direction.z);
  if (direction.z < -1e-12) range.x = max(range.x, ahead / direction.z);
  if (abs(direction.z) <= 1e-12 && ahead < 0.0) range.y = range.x;
  return range;
}

struct Walk {
  vec3 colour;
  float depth, left;
  float first_m;  // from the new eye to what is seen first
  bool uncovered, filled;
};

// A stretch of the new ray in distances from the old eye, `path` metres long.
struct Stretch {
  float low, high, path_per_m;
};

// What layer m of a pixel has on a stretch: emission (colour times optical depth) and optical depth. `before` is the
// optical depth of the layers in front; false: there are no more up to there.
bool layer_on(Stretch on, uint pixel, int m, inout float before, inout vec4 sum, float weight, inout bool behind) {
  const BraceLayer layer = brace_layer_load(pixel * uint(BRACE_LAYERS_COUNT) + uint(m));
  if (layer.end_m <= layer.begin_m || layer.begin_m >= on.high) return false;  // they come in the order of distance
  before += layer.depth;
  float end_m = layer.end_m;
  float depth = layer.depth;
  if (before >= STOPPED_DEPTH && on.high > end_m) {
    if (on.low >= end_m) behind = true;
#if defined(BRACE_WARP_BEHIND_EXTEND) || defined(BRACE_STEREO_BEHIND_EXTEND)
    // As dense as the layer was on the average: the picture of an old eye has nothing else to tell.
    depth *= (on.high - layer.begin_m) / (end_m - layer.begin_m);
    end_m = on.high;
#endif
  }
  const float overlap = min(on.high, end_m) - max(on.low, layer.begin_m);
  if (overlap <= 0.0) return true;
  const float here = min(depth * (overlap / (end_m - layer.begin_m)) * on.path_per_m, 1e6) * weight;
  // c from C = c (1 - exp(-tau)); where nothing is absorbed, C = c tau.
  const float opacity = layer.depth > 1e-3 ? 1.0 - exp2(-layer.depth) : max(layer.depth * 0.69314718, 1e-12);
  sum += vec4(min(layer.colour / opacity, vec3(1.0)) * here, here);
  return true;
}

float segment_begin;  // of the segment at hand, metres along the new ray

void composite(inout Walk walk, vec4 sum) {
  if (sum.a <= 0.0) return;
  walk.first_m = min(walk.first_m, segment_begin);
  walk.depth += sum.a;
  const float left = exp2(-walk.depth);
  walk.colour += (walk.left - left) * (sum.rgb / sum.a);
  walk.left = left;
}

#if defined(BRACE_WARP_FILTER_NEAREST) || defined(BRACE_STEREO_FILTER_NEAREST)
void take(inout Walk walk, vec2 pixel, Stretch on) {
  const uint index = ray_of(uint(pixel.y) * view.grid.z + uint(pixel.x));
  float before = 0.0;
  for (int m = 0; m < BRACE_LAYERS_COUNT; ++m) {
    vec4 sum = vec4(0.0);
    bool behind = false;
    const bool more = layer_on(on, index, m, before, sum, 1.0, behind);
    walk.filled = walk.filled || behind && walk.left > HOLE_LEFT;
    if (!more) break;
    composite(walk, sum);
  }
}
#else
// The four pixels around, layer by layer: the first of one is taken to go on in the first of the next.
void take(inout Walk walk, vec2 pixel, Stretch on) {
  const vec2 inner = clamp(pixel - 0.5, vec2(0.0), vec2(view.grid.zw) - 1.0);
  const uvec2 corner = uvec2(inner), beside = min(corner + 1u, view.grid.zw - 1u);
  const vec2 f = inner - vec2(corner);
  const uvec4 indices = uvec4(corner.y, corner.y, beside.y, beside.y) * view.grid.z + uvec4(corner.x, beside.x, corner.x, beside.x);
  const uvec4 rays = uvec4(ray_of(indices.x), ray_of(indices.y), ray_of(indices.z), ray_of(indices.w));
  const vec4 weights = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
  vec4 before = vec4(0.0);
  bvec4 more = greaterThan(weights, vec4(1e-3));
  for (int m = 0; m < BRACE_LAYERS_COUNT && any(more); ++m) {
    vec4 sum = vec4(0.0);
    bool behind = false;
    [[unroll]] for (int i = 0; i < 4; ++i)
      if (more[i]) more[i] = layer_on(on, rays[i], m, before[i], sum, weights[i], behind);
    walk.filled = walk.filled || behind && walk.left > HOLE_LEFT;
    composite(walk, sum);
  }
}
#endif

void segment(inout Walk walk, float t1, float t2) {
  const vec2 pixel = old_pixel(point_at(0.5 * (t1 + t2)));
  if (!inside(pixel)) {
    walk.uncovered = true;
    return;
  }
  segment_begin = t1;
  const float d1 = length(point_at(t1)), d2 = length(point_at(t2));
  const float low = min(d1, d2), high = max(max(d1, d2), low + 1e-7);
  take(walk, pixel, Stretch(low, high, (t2 - t1) / (high - low)));
}

#if defined(BRACE_WARP_SAMPLING_EXACT) || defined(BRACE_STEREO_SAMPLING_EXACT)
// Where the ray crosses a column (axis 0) or row (axis 1) border of the old picture.
float crossing(int axis, float border) {
  const float tangent = border * view.rays[axis + 2] + view.rays[axis];
  const float divisor = direction[axis] + tangent * direction.z;
  return abs(divisor) > 1e-12 ? -(origin[axis] + tangent * origin.z) / divisor : 1e30;
}

uint march(inout Walk walk, float begin, float end) {
  const vec2 first = floor(old_pixel(point_at(begin))), last = floor(old_pixel(point_at(end)));
  const vec2 way = sign(last - first);
  vec2 border = first + max(way, vec2(0.0));
  // As many as there are between the ends, whatever rounding says of where: within a pixel none.
  ivec2 crossings = ivec2(min(abs(last - first), vec2(view.grid.zw) + 2.0));
  float t = begin;
  uint segments = 0u;
  while (t < end && walk.left > 0.004) {
    const vec2 next = vec2(crossings.x > 0 ? crossing(0, border.x) : 1e30, crossings.y > 0 ? crossing(1, border.y) : 1e30);
    const int axis = next.x <= next.y ? 0 : 1;
    const float to = clamp(min(next.x, next.y), t, end);
    crossings[axis] -= 1;
    border[axis] += way[axis];
    if (to > t) {
      segment(walk, t, to);
      ++segments;
    }
    t = to;
    if (all(lessThanEqual(crossings, ivec2(0))) && t < end) {
      segment(walk, t, end);
      return segments + 1u;
    }
  }
  return segments;
}
#else
uint march(inout Walk walk, float begin, float end) {
  const float dt = (end - begin) / float(BRACE_LAYERS_STEPS);
  uint segments = 0u;
  for (int i = 0; i < BRACE_LAYERS_STEPS && walk.left > 0.004; ++i) {
    segment(walk, begin + float(i) * dt, begin + float(i + 1) * dt);
    ++segments;
  }
  return segments;
}
#endif

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, view.grid.xy))) return;
  const vec2 tangents = view.fov.xy + (vec2(pixel) + 0.5) * view.fov.zw;
#if defined(BRACE_WARP_SCAN_OUT_LINES)
  const float scan = novel_scan[pixel.y * view.grid.x + pixel.x];
#endif
  origin = OLD_FROM_NEW(3);
  direction = normalize(OLD_FROM_NEW(0) * tangents.x + OLD_FROM_NEW(1) * tangents.y - OLD_FROM_NEW(2));
  Walk walk = Walk(vec3(0.0), 0.0, 1.0, uintBitsToFloat(0x7f800000u), false, false);
  const vec2 range = range_in_box();
  uint segments = 0u;
  if (range.x < range.y) segments = march(walk, range.x, range.y);
  const float opacity = clamp(1.0 - walk.left, 0.0, 1.0);
  novel_image[pixel.y * view.grid.x + pixel.x] =
      packUnorm4x8(vec4(clamp(walk.colour, vec3(0.0), vec3(opacity)), opacity));
#if defined(BRACE_NOVEL_HOLES)
  const bool hole = (walk.uncovered || walk.filled) && walk.left > HOLE_LEFT;
  novel_holes[pixel.y * view.grid.x + pixel.x] = hole ? 1u : 0u;
#endif
  novel_depth_m[pixel.y * view.grid.x + pixel.x] = walk.first_m;
  atomicAdd(walked, segments);
  if (walk.uncovered) atomicAdd(uncovered, 1u);
  if (walk.filled) atomicAdd(filled, 1u);
}
