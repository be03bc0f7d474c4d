// Adaptive steps: the ray is cut into cells of 2^top smallest steps, and a cell is halved until the whole and its
// two halves tell the same. Both sum to the transmittance and the colour of the cell; for rules of second order
// the error of the halves is a third of what they differ by. It is weighed with the transmittance before the
// cell: behind what is nearly opaque steps are long. A cell is kept when that error is at most a fraction of the
// tolerance, the same for every cell, which is what costs the fewest samples; rays in real volumes have some
// tens of cells that matter, and their errors differ in sign.
//
// Samples lie on a lattice of integers (in smallest steps), none is taken twice: the middle of a cell is an end
// of its halves, and the ends of cells still to come wait in a stack. Cells start anew at multiples of 2^top,
// whatever came before: leaping over cells in which nothing is visible changes no bit of the others.
#include "dvr_segment.glsl"

#define DVR_LEVELS_MAX 8
#define DVR_SHARE (1.0 / 8.0)  // of the tolerance, for the error of one cell

struct DvrPoint {
  float t;  // units from the entry
  vec3 voxel;
  float coordinate;
};

DvrPoint dvr_point(BraceRay ray, int i) {
  DvrPoint at;
  at.t = min(float(i) * cast_step_voxels_min, ray.extent);
  at.voxel = ray.entry + at.t * ray.direction;
  at.coordinate = brace_transfer_coordinate(brace_value(brace_fetch(at.voxel)));
  return at;
}

struct DvrPart {
  float depth;
  vec3 colour;
};

DvrPart dvr_part(DvrEnd front, DvrEnd back, float length_units) {
  DvrPart part;
  part.depth = dvr_segment_depth(front, back) * (length_units / cast_step_voxels);
  part.colour = dvr_segment_colour(front, back, part.depth);
  return part;
}

// Colour and opacity of a part by itself; 1 - exp2(-x) without cancelling where x is small.
vec4 dvr_shown(DvrPart part) {
  const float x = part.depth * 0.6931471805599453;
  const float opacity = x < 1e-3 ? x * (1.0 - 0.5 * x) : 1.0 - exp2(-part.depth);
  return vec4(part.colour * opacity, opacity);
}

float dvr_error(DvrPart whole, DvrPart first, DvrPart second) {
  const vec4 near = dvr_shown(first);
  const vec4 difference = abs(near + (1.0 - near.w) * dvr_shown(second) - dvr_shown(whole));
  return max(max(difference.x, difference.y), max(difference.z, difference.w)) * (1.0 / 3.0);
}

struct DvrState {
  float depth;  // optical, in powers of two
  float transmittance;
  vec3 colour;
};

void dvr_add(BraceRay ray, inout BraceResult result, inout DvrState state, DvrPart part, float begin, float end,
             vec3 part_colour) {
  brace_emit_segment(ray, begin, end, part_colour, part.depth);
  result.depth = min(result.depth, 0.5 * (begin + end));
  state.depth += part.depth;
  const float left = exp2(-state.depth);
  state.colour += (state.transmittance - left) * part_colour;
  state.transmittance = left;
}

void brace_cast(BraceRay ray, inout BraceResult result) {
  BRACE_COUNTERS_DECLARE
  const int count = int(ceil(ray.extent / cast_step_voxels_min));
  // A cell has at least two steps: its middle lies on the lattice.
  const int top = clamp(int(floor(log2(cast_step_voxels_max / cast_step_voxels_min) + 1.001)), 1, DVR_LEVELS_MAX);
  DvrState state = DvrState(0.0, 1.0, vec3(0.0));
  brace_emit_begin(ray);
  float waiting[DVR_LEVELS_MAX + 1];  // coordinate at the end of the cell of each level
  DvrPoint start = dvr_point(ray, 0);
  BRACE_COUNT(samples, 1u);
  int i = 0;
  int level = top;
  float front_coordinate = start.coordinate;
  bool begins = true;  // a cell of the top level: its end is not known yet
  while (i < count) {
    const int size = 1 << level;
    if (begins) {
      waiting[top] = dvr_point(ray, i + size).coordinate;
      BRACE_COUNT(samples, 1u);
      begins = false;
    }
    const float back_coordinate = waiting[level];
    const DvrPoint middle = dvr_point(ray, i + size / 2);
    BRACE_COUNT(samples, 1u);
    const DvrEnd front = dvr_end(front_coordinate);
    const DvrEnd centre = dvr_end(middle.coordinate);
    const DvrEnd back = dvr_end(back_coordinate);
    const float begin_t = float(i) * cast_step_voxels_min;
    const float end_t = min(float(i + size) * cast_step_voxels_min, ray.extent);
    const DvrPart whole = dvr_part(front, back, end_t - begin_t);
    const DvrPart first = dvr_part(front, centre, middle.t - begin_t);
    const DvrPart second = dvr_part(centre, back, end_t - middle.t);
    if (level > 1 && state.transmittance * dvr_error(whole, first, second) > DVR_SHARE * cast_tolerance) {
      level -= 1;
      waiting[level] = middle.coordinate;
      continue;
    }
    if (first.depth > 0.0) {
      const vec3 at = ray.entry + 0.5 * (begin_t + middle.t) * ray.direction;
      dvr_add(ray, result, state, first, begin_t, middle.t, brace_shade(ray, at, first.colour));
      BRACE_COUNT(shading_fetches, BRACE_SHADE_FETCHES);
    }
    if (second.depth > 0.0) {
      const vec3 at = ray.entry + 0.5 * (middle.t + end_t) * ray.direction;
      dvr_add(ray, result, state, second, middle.t, end_t, brace_shade(ray, at, second.colour));
      BRACE_COUNT(shading_fetches, BRACE_SHADE_FETCHES);
    }
    i += size;
    front_coordinate = back_coordinate;
    if (cast_termination_opacity < 1.0 && state.transmittance <= 1.0 - cast_termination_opacity) break;
    // The next cell: as large as where it starts allows. A second half ends where its parent does.
    const int next = min(findLSB(i), top);
    begins = next == top;
    if (!begins) waiting[next] = waiting[next + 1];
#if defined(BRACE_SKIP)
    if (begins && level == top && !(whole.depth > 0.0) && !(first.depth > 0.0) && !(second.depth > 0.0) && i < count) {
      // Samples i … i + leap - 1 lie where nothing is visible: so do the cells between them.
      int landing = i;
      BRACE_NEXT_SAMPLE(ray, ray.entry + end_t * ray.direction, landing, cast_step_voxels_min);
      const int cells = (landing - 1 - i) >> top;
      if (cells > 0) {
        i += cells << top;
        if (i < count) {
          front_coordinate = dvr_point(ray, i).coordinate;
          BRACE_COUNT(samples, 1u);
        }
      }
    }
#endif
    level = next;
  }
  brace_emit_end(ray, min(float(i) * cast_step_voxels_min, ray.extent));
  const float opacity = clamp(1.0 - state.transmittance, 0.0, 1.0);
  result.colour = vec4(clamp(state.colour, vec3(0.0), vec3(opacity)), opacity);
  BRACE_COUNTERS_COMMIT;
}
