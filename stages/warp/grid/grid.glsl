// The eye frame as a surface through its first hits, seen from the new pose (after Buchacher 2017, 5.3.2, who draws
// it as a mesh). Here each pixel looks its own point up: along its ray, from near to far, the old picture's depths are
// asked until the ray is behind them. In the old picture that ray is a straight line; it is walked in steps of w, one
// over the distance in units of the direction, from where the scene begins to where it ends, and from there to infinity
// (w = 0) in one.
#define BRACE_WARP_PER_PIXEL
#if defined(BRACE_WARP_SEARCH_FOUR)
#define BRACE_WARP_PER_FOUR
#endif

layout(set = 0, binding = BRACE_SLOT_SOURCE_DEPTH) uniform samplerBuffer brace_source_depth_m;

// Nearer to the old eye's plane than this share of the direction's length there is no picture.
#define GRID_BESIDE 1e-3

vec2 grid_parallax = vec2(0.0);  // tangents, from where the pixel's direction lies at infinity to where its point is

// 1 / depth of the old picture's nearest pixel; 0 where it hit nothing, or has no number.
float grid_inverse_depth(vec2 tan_xy) {
  const vec2 position = tan_xy * brace_display.source.xy + brace_display.source.zw + 0.5;
  const ivec2 texel = ivec2(clamp(position, vec2(0.0), brace_display.source_max.zw));
  const float depth_m = texelFetch(brace_source_depth_m, texel.y * int(brace_display.grid.x) + texel.x).x;
  return depth_m > 0.0 ? 1.0 / depth_m : 0.0;
}

// A point of the ray, and how far in front of the old picture's surface it is (in 1 / m).
struct GridPoint {
  vec2 tan_xy;
  float inverse_depth, in_front;
};

GridPoint grid_point(vec3 direction, vec3 origin_m, float w) {
  const vec3 p = direction + w * origin_m;
  GridPoint point;
  point.tan_xy = p.xy / max(-p.z, GRID_BESIDE);
  point.inverse_depth = grid_inverse_depth(point.tan_xy);
  point.in_front = w * inversesqrt(max(dot(p, p), 1e-12)) - point.inverse_depth;
  return point;
}

vec2 grid_crossing(GridPoint before, GridPoint behind) {
#if defined(BRACE_WARP_EDGES_CUT)
  const float larger = max(before.inverse_depth, behind.inverse_depth);
  if (abs(before.inverse_depth - behind.inverse_depth) > warp_jump * larger) {
    // The ray has come behind an edge, where the old eye saw nothing: what lies farther away goes on there.
    brace_warp_filled = behind.inverse_depth > before.inverse_depth;
    return brace_warp_filled ? before.tan_xy : behind.tan_xy;
  }
#endif
  const float t = before.in_front / max(before.in_front - behind.in_front, 1e-20);
  return mix(before.tan_xy, behind.tan_xy, clamp(t, 0.0, 1.0));
}

// Where the ray first is behind the surface between w.x and w.y, in `count` steps, or else at infinity.
vec2 grid_search(vec3 direction, vec3 origin_m, vec2 w, float count) {
  GridPoint before = grid_point(direction, origin_m, w.x);
  if (before.in_front <= 0.0) return before.tan_xy;
  for (float i = 1.0; i <= count; i += 1.0) {
    const GridPoint next = grid_point(direction, origin_m, mix(w.x, w.y, i / count));
    if (next.in_front <= 0.0) return grid_crossing(before, next);
    before = next;
  }
  return grid_crossing(before, grid_point(direction, origin_m, 0.0));
}

// w where the ray comes to the scene and where it has left it, by the triangle of the two eyes and the point: not nearer
// than near_m, and in front of the old eye. No branch here hangs on uniforms alone: lavapipe puts their values into the
// kernel, and pays for that at every dispatch.
vec2 grid_range(vec3 direction, vec3 origin_m) {
  const float apart_m = length(origin_m), per_m = length(direction);
  const float nearest_m = brace_display.old_from_new[0].w - apart_m, farthest_m = brace_display.old_from_new[1].w + apart_m;
  const float w_near = min(1.0 / warp_near_m, per_m / max(nearest_m, 1e-6));
  const float w_max = -(direction.z + w_near * origin_m.z) > GRID_BESIDE ? w_near : (-direction.z - GRID_BESIDE) / origin_m.z;
  return vec2(w_max, min(per_m / farthest_m, w_max));
}

// Tangents of a point of the ray in the old picture; within grid_range.
vec2 grid_tangents(vec3 direction, vec3 origin_m, float w) {
  const vec3 p = direction + w * origin_m;
  return p.xy / -p.z;
}

void brace_warp_pixel(vec2 tan_xy) {
  grid_parallax = vec2(0.0);
  const vec3 origin_m = brace_new_eye_m();
  const vec3 direction = brace_old_from_new(vec3(tan_xy, -1.0)) - origin_m;
  if (-direction.z <= GRID_BESIDE) return;
  const vec2 w = grid_range(direction, origin_m);
  const vec2 at_infinity = direction.xy / -direction.z;
  const vec2 path = grid_tangents(direction, origin_m, w.x) - at_infinity;
  const vec2 path_px = abs(path * brace_display.source.xy);
  // Within a pixel there is no edge to look for, and the path is as good as linear in w.
  if (max(path_px.x, path_px.y) <= 1.0) {
    grid_parallax = path * clamp(grid_inverse_depth(at_infinity) * length(direction) / w.x, 0.0, 1.0);
    return;
  }
  const vec2 search_px = abs((path - (grid_tangents(direction, origin_m, w.y) - at_infinity)) * brace_display.source.xy);
  const float steps = clamp(ceil(max(search_px.x, search_px.y)), 1.0, float(warp_steps));
  grid_parallax = grid_search(direction, origin_m, w, steps) - at_infinity;
}

vec2 brace_warp_source(vec2 tan_xy) {
  const vec3 direction = brace_old_from_new(vec3(tan_xy, -1.0)) - brace_new_eye_m();
  return -direction.z > GRID_BESIDE ? direction.xy / -direction.z + grid_parallax : BRACE_NO_SOURCE;
}
