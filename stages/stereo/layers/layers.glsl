// Ray casting with re-projection of segments (Buchacher, Algorithm 2). Unlike there a segment that crosses pixels
// is cut at their borders, its optical depth in proportion, so that no opacity counts twice; and what is open
// when the ray ends early is written. From the middle a ray leaves its segments for both eyes.
#extension GL_EXT_control_flow_attributes : require
#define BRACE_EMIT
#if defined(BRACE_STEREO_BY_TEXEL)
#define BRACE_EMIT_NOTHING
#endif
#include "layers_store.glsl"

#if defined(BRACE_STEREO_REFERENCE_MIDDLE)
#define STEREO_EYES 2
#else
#define STEREO_EYES 1
#endif
const int stereo_none = -1000000;

#if defined(BRACE_STEREO_BY_TEXEL)
// rays/mab's: x | y << 14 | level << 28, or none. Each level is a picture of its own.
layout(std430, set = 0, binding = 25) readonly buffer BraceMabTexels { uint stereo_texel_of_ray[]; };
uint stereo_texel() { return stereo_texel_of_ray[brace_ray_index(brace_area.origin + gl_GlobalInvocationID.xy)]; }
#endif

// What a ray leaves in one picture.
struct StereoTrace {
  uvec2 cell;     // of the ray, in the order of the picture's columns
  bool leaves;    // any segments
  uint row;       // its layer's first texel
  float line;     // the column of the ray's point at infinity
  int low, high;  // columns that the volume can fall on: what the layers were counted for
  int first, column;
  float depth;  // optical, in powers of two, of the column so far
  float left;   // its transmittance
  vec3 colour;  // premultiplied
};
StereoTrace stereo_traces[STEREO_EYES];
uint stereo_texels_written;
float stereo_begin_z, stereo_dz;

bool stereo_is_seen(int column) { return column >= 0 && column < int(stereo.columns.y); }

// The pictures of eye i that a ray falls on.
void stereo_choose(int i, out uvec2 cell) {
  cell = brace_area.origin + gl_GlobalInvocationID.xy;
#if defined(BRACE_STEREO_BY_TEXEL)
  const uint texel = stereo_texel();
  cell = uvec2(texel & 0x3fffu, texel >> 14 & 0x3fffu);
  stereo_picture = uint(i) * stereo_pictures[0].first.w + (texel >> 28);
#elif STEREO_EYES > 1
  stereo_picture = uint(i);
#endif
  cell = stereo_in_order(cell);
}

void stereo_begin(inout StereoTrace trace, uvec2 cell) {
  trace.cell = cell;
  trace.leaves = stereo_is_sampled(cell);
  trace.row = stereo_row_of(cell);
  trace.line = stereo_line_of(int(cell.x), cell.y);
  trace.low = int(floor(trace.line - stereo.line.z / stereo.depths.x));
  trace.high = int(floor(trace.line - stereo.line.z / stereo.depths.y));
  trace.first = stereo_none;
  trace.column = stereo_none;
}

int stereo_column_at(StereoTrace trace, float z) {
  return int(floor(clamp(trace.line - stereo.line.z / z, float(trace.low), float(trace.high))));
}

void stereo_write(StereoTrace trace) {
  if (stereo_is_seen(trace.column)) {
    const float opacity = 1.0 - trace.left;
    stereo_store(trace.row + uint(trace.column), vec4(min(trace.colour, vec3(opacity)), opacity));
    ++stereo_texels_written;
  }
}

void stereo_add(inout StereoTrace trace, int column, vec3 colour, float depth) {
  if (column != trace.column) {
    if (trace.column == stereo_none) {
      trace.first = column;
    } else {
      stereo_write(trace);
      for (int gap = trace.column + 1; gap < column; ++gap)
        if (stereo_is_seen(gap)) {
          stereo_store(trace.row + uint(gap), vec4(0.0));
          ++stereo_texels_written;
        }
    }
    trace.column = column;
    trace.depth = 0.0;
    trace.left = 1.0;
    trace.colour = vec3(0.0);
  }
#if defined(BRACE_STEREO_PATH_LENGTH_OWN)
  // Both rays cross the same depths: lengths are as the secants of their angles.
  const float shift = float(stereo_phase(trace.cell.y));
  const float own_x = stereo.tangents.x + ((float(column) + 0.5) / stereo.columns.x - shift) * stereo.tangents.y;
  const float ray_x = stereo.tangents.x + (trace.line / stereo.columns.x - shift) * stereo.tangents.y;
  depth *= sqrt(max(1.0 + stereo_dz * stereo_dz * (own_x * own_x - ray_x * ray_x), 0.0));
#endif
  trace.depth += depth;
  const float left = exp2(-trace.depth);
  trace.colour += (trace.left - left) * colour;
  trace.left = left;
}

void stereo_segment(inout StereoTrace trace, float begin, float end, vec3 colour, float optical_depth) {
  if (!trace.leaves || !(end > begin)) return;
  const float per_unit = min(optical_depth, 1e9) / (end - begin);
  int column = stereo_column_at(trace, stereo_begin_z + begin * stereo_dz);
  const int last = stereo_column_at(trace, stereo_begin_z + end * stereo_dz);
  float from = begin;
  for (; column < last; ++column) {
    const float border_z = stereo.line.z / (trace.line - float(column + 1));
    const float border = clamp((border_z - stereo_begin_z) / stereo_dz, from, end);
    stereo_add(trace, column, colour, (border - from) * per_unit);
    from = border;
  }
  stereo_add(trace, last, colour, (end - from) * per_unit);
}

// The ray was cast and has left columns first … behind - 1; up to until - 1 nothing is known of it.
void stereo_note(StereoTrace trace, uint first, uint behind, uint until) {
  stereo_ranges[stereo_range_of(trace.cell)] = uvec2(first | behind << 16, stereo.layers.y | until << 16);
}

void stereo_end(StereoTrace trace, float extent, float end) {
  if (trace.column == stereo_none) {
#if defined(BRACE_STEREO_BY_TEXEL)
    stereo_note(trace, 1u, 0u, 0u);
#endif
    return;
  }
  stereo_write(trace);
  const int width = int(stereo.columns.y);
  const bool stopped = end < 0.9999 * extent;
  const int exit = stereo_column_at(trace, stereo_begin_z + extent * stereo_dz) + 1;
  stereo_note(trace, uint(clamp(trace.first, 0, width)), uint(clamp(trace.column + 1, 0, width)),
              stopped ? uint(clamp(exit, 0, width)) : 0u);
}

void brace_emit_begin(BraceRay ray) {
  stereo_texels_written = 0u;
  // The eyes look the same way.
  const vec3 forward = stereo_pictures[0].forward.xyz;
  stereo_begin_z = dot(forward, (ray.entry - brace_eye.eye.xyz) / brace_eye.voxels_per_unit.xyz);
  stereo_dz = dot(forward, ray.direction / brace_eye.voxels_per_unit.xyz);
  [[unroll]] for (int i = 0; i < STEREO_EYES; ++i) {
    uvec2 cell;
    stereo_choose(i, cell);
    stereo_begin(stereo_traces[i], cell);
  }
}

void brace_emit_segment(BraceRay ray, float begin, float end, vec3 colour, float optical_depth) {
  [[unroll]] for (int i = 0; i < STEREO_EYES; ++i) {
#if STEREO_EYES > 1
    uvec2 cell;
    stereo_choose(i, cell);
#endif
    stereo_segment(stereo_traces[i], begin, end, colour, optical_depth);
  }
}

void brace_emit_end(BraceRay ray, float end) {
  [[unroll]] for (int i = 0; i < STEREO_EYES; ++i) {
#if STEREO_EYES > 1
    uvec2 cell;
    stereo_choose(i, cell);
#endif
    stereo_end(stereo_traces[i], ray.extent, end);
  }
#if defined(BRACE_COUNTERS)
  atomicAdd(stereo_written, stereo_texels_written);
#endif
}

#if defined(BRACE_STEREO_BY_TEXEL)
// A ray that misses the volume knows that there is nothing.
void brace_emit_nothing() {
  if (stereo_texel() == 0xffffffffu) return;
  [[unroll]] for (int i = 0; i < STEREO_EYES; ++i) {
    uvec2 cell;
    stereo_choose(i, cell);
    stereo_begin(stereo_traces[i], cell);
    stereo_end(stereo_traces[i], 0.0, 0.0);
  }
}
#endif
