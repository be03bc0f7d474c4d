// Adaptive steps: the ray is cut into cells of 2^top smallest steps, and a cell is halved until the whole, its two
// halves and the four quarters of a parabola through its three samples tell the same. For rules of second order
// the error of the halves is a third of what they differ from the whole by; the quarters see what the parabola
// passes through and no sample has. The error is weighed with the transmittance before the cell: behind what is
// nearly opaque steps are long. A cell is kept when its error is at most a fraction of the tolerance, the same
// for every cell, which is what costs the fewest samples; rays in real volumes have some tens of cells that
// matter, and their errors differ in sign.
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

vec4 dvr_both(vec4 near, vec4 far) { return near + (1.0 - near.w) * far; }

float dvr_largest(vec4 difference) {
  const vec4 size = abs(difference);
  return max(max(size.x, size.y), max(size.z, size.w));
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
  // Cells of the top level begin at its multiples; half of one may lie in front of a depth told.
  const float cell_units = float(1 << top) * cast_step_voxels_min;
  int i = 0;
  BRACE_BEGIN_RAY(ray, i, 0.0, cast_step_voxels_min, cell_units);
  i = clamp(i - 1, 0, count) >> top << top;  // from the last sample of what is empty on
  DvrPoint start = dvr_point(ray, i);
  BRACE_COUNT(samples, 1u);
  int level = top;
  float front_coordinate = start.coordinate;
  bool begins = true;  // a cell of the top level: its end is not known yet
  while (i < count) {
    if (begins) {
#if defined(BRACE_SKIP)
      // Samples i … i + leap - 1 lie where nothing is visible: so do the cells between them.
      if (!(brace_optical_depth(front_coordinate) > 0.0)) {
        int landing = i;
        BRACE_NEXT_SAMPLE(ray, ray.entry + float(i) * cast_step_voxels_min * ray.direction, landing, cast_step_voxels_min);
        const int cells = (landing - 1 - i) >> top;
        if (cells > 0) {
          i += cells << top;
          if (i < count) {
            front_coordinate = dvr_point(ray, i).coordinate;
            BRACE_COUNT(samples, 1u);
          }
          continue;
        }
      }
#endif
      waiting[top] = dvr_point(ray, i + (1 << top)).coordinate;
      BRACE_COUNT(samples, 1u);
      begins = false;
    }
    const int size = 1 << level;
    const float back_coordinate = waiting[level];
    const DvrPoint middle = dvr_point(ray, i + size / 2);
    BRACE_COUNT(samples, 1u);
    const DvrEnd front = dvr_end(front_coordinate);
    const DvrEnd centre = dvr_end(middle.coordinate);
    const DvrEnd back = dvr_end(back_coordinate);
    const float begin_t = float(i) * cast_step_voxels_min;
    const float end_t = min(float(i + size) * cast_step_voxels_min, ray.extent);
    const DvrPart first = dvr_part(front, centre, middle.t - begin_t);
    const DvrPart second = dvr_part(centre, back, end_t - middle.t);
    if (level > 1) {
      const vec4 halves = dvr_both(dvr_shown(first), dvr_shown(second));
      const vec4 whole = dvr_shown(dvr_part(front, back, end_t - begin_t));
      float error = dvr_largest(halves - whole) * (1.0 / 3.0);
      // What a parabola through the three values shows: it may pass through values that no sample has.
      const float bend = 0.125 * (front_coordinate - 2.0 * middle.coordinate + back_coordinate);
      const DvrEnd early = dvr_end(0.5 * (front_coordinate + middle.coordinate) - bend);
      const DvrEnd late = dvr_end(0.5 * (middle.coordinate + back_coordinate) - bend);
      const float quarter = 0.25 * (end_t - begin_t);
      const vec4 quarters = dvr_both(
          dvr_both(dvr_shown(dvr_part(front, early, quarter)), dvr_shown(dvr_part(early, centre, quarter))),
          dvr_both(dvr_shown(dvr_part(centre, late, quarter)), dvr_shown(dvr_part(late, back, quarter))));
      error = max(error, dvr_largest(quarters - halves));
      // Between samples farther apart than half a voxel something thin may hide whose slopes only they have met.
      const float most = max(middle.coordinate, max(front_coordinate, back_coordinate));
      const float least = min(middle.coordinate, min(front_coordinate, back_coordinate));
      const bool may_hide = 2.0 * most - least > brace_eye.transfer.w && !(first.depth + second.depth > 0.0) &&
                            float(size) * cast_step_voxels_min > 1.0;
      if (may_hide || state.transmittance * error > DVR_SHARE * cast_tolerance) {
        level -= 1;
        waiting[level] = middle.coordinate;
        continue;
      }
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
    level = next;
  }
  brace_emit_end(ray, min(float(i) * cast_step_voxels_min, ray.extent));
  const float opacity = clamp(1.0 - state.transmittance, 0.0, 1.0);
  result.colour = vec4(clamp(state.colour, vec3(0.0), vec3(opacity)), opacity);
  BRACE_COUNTERS_COMMIT;
}
