// Ray casting with re-projection of segments (Buchacher, Algorithm 2). Unlike there a segment that crosses pixels
// is cut at their borders, its optical depth in proportion, so that no opacity counts twice; and what is open
// when the ray ends early is written.
#define BRACE_EMIT
#include "layers_store.glsl"

const int stereo_none = -1000000;

uvec2 stereo_cell;
bool stereo_leaves;          // this ray leaves segments
uint stereo_texels_written;
uint stereo_row;
float stereo_line;           // the column of the ray's point at infinity
float stereo_begin_z, stereo_dz;
int stereo_low, stereo_high;  // columns that the volume can fall on: what the layers were counted for
int stereo_first, stereo_column;
float stereo_depth;  // optical, in powers of two, of the column so far
float stereo_left;   // its transmittance
vec3 stereo_colour;  // premultiplied

bool stereo_is_seen(int column) { return column >= 0 && column < int(stereo.columns.y); }

void brace_emit_begin(BraceRay ray) {
  stereo_cell = brace_area.origin + gl_GlobalInvocationID.xy;
  stereo_leaves = stereo_is_sampled(stereo_cell);
  stereo_texels_written = 0u;
  stereo_row = stereo_row_of(stereo_cell);
  stereo_begin_z = dot(stereo.forward.xyz, (ray.entry - brace_eye.eye.xyz) / brace_eye.voxels_per_unit.xyz);
  stereo_dz = dot(stereo.forward.xyz, ray.direction / brace_eye.voxels_per_unit.xyz);
  stereo_line = stereo_line_of(int(stereo_cell.x), stereo_cell.y);
  stereo_low = int(floor(stereo_line - stereo.line.z / stereo.depths.x));
  stereo_high = int(floor(stereo_line - stereo.line.z / stereo.depths.y));
  stereo_first = stereo_none;
  stereo_column = stereo_none;
}

int stereo_column_at(float z) {
  return int(floor(clamp(stereo_line - stereo.line.z / z, float(stereo_low), float(stereo_high))));
}

void stereo_write() {
  if (stereo_is_seen(stereo_column)) {
    const float opacity = 1.0 - stereo_left;
    stereo_store(stereo_row + uint(stereo_column), vec4(min(stereo_colour, vec3(opacity)), opacity));
    ++stereo_texels_written;
  }
}

void stereo_add(int column, vec3 colour, float depth) {
  if (column != stereo_column) {
    if (stereo_column == stereo_none) {
      stereo_first = column;
    } else {
      stereo_write();
      for (int gap = stereo_column + 1; gap < column; ++gap)
        if (stereo_is_seen(gap)) {
          stereo_store(stereo_row + uint(gap), vec4(0.0));
          ++stereo_texels_written;
        }
    }
    stereo_column = column;
    stereo_depth = 0.0;
    stereo_left = 1.0;
    stereo_colour = vec3(0.0);
  }
#if defined(BRACE_STEREO_PATH_LENGTH_OWN)
  // Both rays cross the same depths: lengths are as the secants of their angles.
  const float shift = float(stereo_phase(stereo_cell.y));
  const float own_x = stereo.tangents.x + ((float(column) + 0.5) / stereo.columns.x - shift) * stereo.tangents.y;
  const float ray_x = stereo.tangents.x + (stereo_line / stereo.columns.x - shift) * stereo.tangents.y;
  depth *= sqrt(max(1.0 + stereo_dz * stereo_dz * (own_x * own_x - ray_x * ray_x), 0.0));
#endif
  stereo_depth += depth;
  const float left = exp2(-stereo_depth);
  stereo_colour += (stereo_left - left) * colour;
  stereo_left = left;
}

void brace_emit_segment(BraceRay ray, float begin, float end, vec3 colour, float optical_depth) {
  if (!stereo_leaves || !(end > begin)) return;
  const float per_unit = min(optical_depth, 1e9) / (end - begin);
  int column = stereo_column_at(stereo_begin_z + begin * stereo_dz);
  const int last = stereo_column_at(stereo_begin_z + end * stereo_dz);
  float from = begin;
  for (; column < last; ++column) {
    const float border_z = stereo.line.z / (stereo_line - float(column + 1));
    const float border = clamp((border_z - stereo_begin_z) / stereo_dz, from, end);
    stereo_add(column, colour, (border - from) * per_unit);
    from = border;
  }
  stereo_add(last, colour, (end - from) * per_unit);
}

void brace_emit_end(BraceRay ray, float end) {
  if (stereo_column == stereo_none) return;
  stereo_write();
  const int width = int(stereo.columns.y);
  const uint first = uint(clamp(stereo_first, 0, width));
  const uint behind = uint(clamp(stereo_column + 1, 0, width));
  const bool stopped = end < 0.9999 * ray.extent;
  const int exit = stereo_column_at(stereo_begin_z + ray.extent * stereo_dz) + 1;
  const uint until = stopped ? uint(clamp(exit, 0, width)) : 0u;
  stereo_ranges[brace_ray_index(stereo_cell)] = uvec2(first | behind << 16, stereo.layers.y | until << 16);
#if defined(BRACE_COUNTERS)
  atomicAdd(stereo_written, stereo_texels_written);
#endif
}
