// A segment of a ray between two samples, for the rules that look at both of its ends. As a midpoint rule does,
// a segment takes the transmittance from T to T exp2(-depth) and adds its colour by what was taken away, so the
// colours added sum up to no more than 1 - T whatever the depth.
struct DvrSegment {
  float depth;  // of a full step, in powers of two
  vec3 colour;  // not premultiplied
};

#if defined(BRACE_CAST_INTEGRATOR_PRE_INTEGRATED)

#if defined(BRACE_CAST_PREINTEGRATION_TABLE) && !defined(BRACE_CAST_TOLERANCE_ON)
#define BRACE_TRANSFER_SEGMENTS
#endif
#include "brace/transfer_integral.glsl"

#define DvrEnd BraceTransferEnd
#define dvr_end brace_transfer_end
#define dvr_segment_depth brace_segment_depth

vec3 dvr_segment_colour(BraceTransferEnd front, BraceTransferEnd back, float depth) {
#if defined(BRACE_TRANSFER_SEGMENTS)
  return brace_segment_ordered_colour(front, back);
#else
  return brace_segment_mean_colour(front, back);
#endif
}

#else

// Linear source: kappa by the trapezoid, the colour linear and weighted by what each place of the segment lets
// through: the weighted mean lies at the place 1 / x - 1 / (exp(x) - 1) of the way, x the optical depth.
struct DvrEnd {
  float depth;
  vec3 colour;
};

DvrEnd dvr_end(float coordinate) {
  const vec4 shown = brace_transfer(coordinate);
  return DvrEnd(shown.w, shown.rgb);
}

float dvr_segment_depth(DvrEnd front, DvrEnd back) { return 0.5 * (front.depth + back.depth); }

float dvr_mean_place(float depth) {
  const float x = depth * 0.6931471805599453;
  if (x < 0.5) return 0.5 - x * (1.0 / 12.0) * (1.0 - x * x * (1.0 / 60.0));
  return 1.0 / x - 1.0 / (exp(min(x, 80.0)) - 1.0);
}

vec3 dvr_segment_colour(DvrEnd front, DvrEnd back, float depth) {
  return front.colour + dvr_mean_place(depth) * (back.colour - front.colour);
}

#endif
