#version 460
// What a cast on the host has told of its segments, told again to the stages that make layers of them: in the
// place of cast_main.comp. Rays, colours and depths are there already.
#define BRACE_KERNEL_CAST
#include "brace/ray_buffers.glsl"
#include "brace/counters.glsl"
#include "stage/parameters.glsl"
#include "stage/stereo.glsl"
#include "stage/warp.glsl"
#include "brace/emit.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

struct BraceSegmentHead {
  uint first, count;  // count: BRACE_SEGMENTS_ELSEWHERE where the ray is told of by another dispatch
  float end;          // units from the entry
};
#define BRACE_SEGMENTS_ELSEWHERE 0xffffffffu
layout(std430, set = 0, binding = BRACE_SLOT_SEGMENT_HEADS) readonly buffer BraceSegmentHeads {
  BraceSegmentHead brace_segment_heads[];  // of the rays of brace_area, row by row
};
layout(std430, set = 0, binding = BRACE_SLOT_SEGMENTS) readonly buffer BraceSegments { float brace_segments[]; };

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, brace_area.size))) return;
  const BraceSegmentHead head =
      brace_segment_heads[gl_GlobalInvocationID.y * brace_area.size.x + gl_GlobalInvocationID.x];
  if (head.count == BRACE_SEGMENTS_ELSEWHERE) return;
  const BraceRay ray = brace_load_ray(brace_ray_index(brace_area.origin + gl_GlobalInvocationID.xy));
  if (ray.extent > 0.0) {
    brace_emit_begin(ray);
    for (uint i = 0u; i < head.count; ++i) {
      const uint at = 6u * (head.first + i);
      brace_emit_segment(ray, brace_segments[at], brace_segments[at + 1u],
                         vec3(brace_segments[at + 2u], brace_segments[at + 3u], brace_segments[at + 4u]),
                         brace_segments[at + 5u]);
    }
    brace_emit_end(ray, head.end);
  } else {
    brace_emit_nothing();
  }
}
