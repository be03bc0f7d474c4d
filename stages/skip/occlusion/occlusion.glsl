// skip/occlusion: what the last frame's rays have passed until their first hits is empty (Mensmann et al.'s occlusion
// frustums). The image of the last frame is cut into tiles; a tile's frustum is empty up to its nearest first hit. A
// ray walks the tiles that its picture in the old view passes and begins where it leaves what they know to be empty.
// Behind its begin another structure may go on.
#if defined(BRACE_SKIP_BEHIND_DISTANCE_MAP)
#include "brace/skip_distance.glsl"
#endif

#include "brace/counters.glsl"
#include "brace/ray.glsl"
#include "brace/skip_params.h"

#define BRACE_SKIP_BEGIN

// Of each tile: units from the old eye to the nearest first hit in it and around it, +infinity without one.
layout(set = 0, binding = 12) uniform samplerBuffer brace_first_hits;
layout(std430, set = 0, binding = 13) readonly buffer BraceOcclusionBlock { BraceOcclusionParams brace_occlusion; };

#define OCCLUSION_TILES_MAX 256  // on one ray's way
#define OCCLUSION_AHEAD_MIN 1e-3  // units in front of the old eye, nearer is not in its picture
#define OCCLUSION_STILL 1e-4      // square of the units that an eye may move and see the same

// One eye frame in `refresh_frames` a work-group's rays begin at their entry: what the space between the old rays has
// hidden is found again.
bool occlusion_is_refreshed() {
  const int frames = int(brace_occlusion.row.w);
  if (frames == 0) return false;
  const uvec2 group = (brace_area.origin + gl_GlobalInvocationID.xy) >> 3;
  return (group.x + 5u * group.y + brace_occlusion.tiles.z) % uint(frames) == 0u;
}

// Units from the entry that are known to be empty.
float occlusion_free(BraceRay ray, float gap, inout uint looks) {
  const vec3 from_eye = ray.entry - brace_occlusion.eye.xyz;
  const vec3 from = vec3(dot(brace_occlusion.column.xyz, from_eye), dot(brace_occlusion.row.xyz, from_eye),
                         dot(brace_occlusion.ahead.xyz, from_eye));
  const vec3 along = vec3(dot(brace_occlusion.column.xyz, ray.direction), dot(brace_occlusion.row.xyz, ray.direction),
                          dot(brace_occlusion.ahead.xyz, ray.direction));
  // Square of the distance to the old eye: t^2 + 2 middle t + begin.
  const vec3 metric = from_eye / brace_eye.voxels_per_unit.xyz;
  const float middle = dot(metric, ray.direction / brace_eye.voxels_per_unit.xyz);
  const float begin = dot(metric, metric);

  // From an eye that stands still a ray starts in the old eye, which is nowhere in its picture.
  float t = begin < OCCLUSION_STILL ? 0.1 : 0.0;
  const vec3 start = from + t * along;
  if (!(start.z > OCCLUSION_AHEAD_MIN)) return 0.0;
  const vec2 first = start.xy / start.z;
  // Where the ray's picture goes to: a straight line, passed in one direction.
  const vec3 end = from + ray.extent * along;
  const vec2 turn = along.xy * from.z - from.xy * along.z;
  const vec2 last = end.z > OCCLUSION_AHEAD_MIN ? end.xy / end.z : first + sign(turn) * 1e9;
  ivec2 tile = ivec2(floor(first));
  const ivec2 tiles = ivec2(brace_occlusion.tiles.xy);
  const bvec2 forth = greaterThan(last, first);
  float known = 0.0;
  for (int i = 0; i < OCCLUSION_TILES_MAX; ++i) {
    if (any(lessThan(tile, ivec2(0))) || any(greaterThanEqual(tile, tiles))) break;
    looks += 1u;
    const float hit = texelFetch(brace_first_hits, tile.y * tiles.x + tile.x).x;
    const float limit = hit - hit * skip_margin_px * brace_occlusion.ahead.w - skip_margin_voxels - gap;
    // The part of the ray that is nearer to the old eye than that.
    const float square = isinf(hit) ? 1.0 : middle * middle - begin + limit * limit;
    if (!(limit > 0.0 || isinf(hit)) || square < 0.0) break;
    const float far = isinf(hit) ? ray.extent : sqrt(square) - middle;
    if (!isinf(hit) && (t >= far || t < -middle - sqrt(square))) break;
    // Where its picture leaves the tile: through a side of the frustum.
    const vec2 side = vec2(tile) + vec2(forth);
    const bvec2 leaves = mix(lessThan(last, side), greaterThanEqual(last, side), forth);
    const vec2 at = (side * from.z - from.xy) / (along.xy - side * along.z);
    const vec2 leave = mix(vec2(1e30), clamp(at, vec2(t), vec2(max(t, ray.extent))), leaves);
    const float until = min(leave.x, leave.y);
    if (far <= until) {
      known = far;
      break;
    }
    known = t = until;
    if (leave.x <= leave.y) {
      tile.x += forth.x ? 1 : -1;
    } else {
      tile.y += forth.y ? 1 : -1;
    }
  }
  return known;
}

int brace_skip_begin(BraceRay ray, float place, float step, float gap, inout uint looks) {
  if (brace_occlusion.tiles.x == 0u || occlusion_is_refreshed()) return 0;
  const float known = occlusion_free(ray, gap, looks);
  if (known >= ray.extent) return int(ray.extent / step) + 2;  // the last sample lies somewhere in the last step
  return known > 0.0 ? max(int(ceil(known / step - place)), 0) : 0;
}
