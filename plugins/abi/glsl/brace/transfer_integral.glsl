// The transfer function pre-integrated over the table coordinate: what a segment shows along which the value
// goes linearly from one end to the other (Engel, Kraus, Ertl 2001; runtime/volume/preintegration.hpp).
//   BraceTransferEnd brace_transfer_end(coordinate)        once per sample; the next segment uses it again
//   float brace_segment_depth(front, back)                 optical depth of a full step, in powers of two
//   vec3 brace_segment_mean_colour(front, back)            colour by opacity, the order within the step neglected
//   vec3 brace_segment_ordered_colour(front, back)         from the two-dimensional table: front before back
// The depth is exact, and 0 exactly where the function shows nothing between the two values.
#ifndef BRACE_TRANSFER_INTEGRAL_GLSL
#define BRACE_TRANSFER_INTEGRAL_GLSL

#include "brace/transfer_function.glsl"

// Two texels per entry: r w, g w, b w, w integrated from 0 to the entry, and what the first one rounded off.
layout(set = 0, binding = BRACE_SLOT_TRANSFER_INTEGRALS) uniform samplerBuffer brace_transfer_integrals;

struct BraceTransferEnd {
  float coordinate;  // clamped to the table
  vec4 sum;          // up to the entry below
  vec4 rest;         // what `sum` rounded off
  vec4 beyond;       // from that entry to the coordinate
};

// Below this distance in entries a difference of integrals would be all rounding.
#define BRACE_SEGMENT_SHORT (1.0 / 32.0)
// integral_depth_max of the host.
#define BRACE_INTEGRAL_DEPTH_MAX 1048576.0

BraceTransferEnd brace_transfer_end(float coordinate) {
  BraceTransferEnd end;
  float place;
  const int entry = brace_transfer_entry(coordinate, place);
  end.coordinate = float(entry) + place;
  end.sum = texelFetch(brace_transfer_integrals, 2 * entry);
  end.rest = texelFetch(brace_transfer_integrals, 2 * entry + 1);
  const vec4 low = texelFetch(brace_transfer_entries, entry);
  const vec4 high = texelFetch(brace_transfer_entries, entry + 1);
  const float w = min(low.w, BRACE_INTEGRAL_DEPTH_MAX);
  const float dw = min(high.w, BRACE_INTEGRAL_DEPTH_MAX) - w;
  const vec3 dc = high.rgb - low.rgb;
  end.beyond.rgb = place * (w * low.rgb + place * (0.5 * (w * dc + dw * low.rgb) + place * (dw * dc) * (1.0 / 3.0)));
  end.beyond.w = place * (w + 0.5 * place * dw);
  return end;
}

vec4 brace_segment_sums(BraceTransferEnd front, BraceTransferEnd back) {
  return (back.sum - front.sum) + ((back.rest - front.rest) + (back.beyond - front.beyond));
}

bool brace_segment_is_short(BraceTransferEnd front, BraceTransferEnd back) {
  return abs(back.coordinate - front.coordinate) < BRACE_SEGMENT_SHORT;
}

// The optical depths that Simpson's rule weighs: exact within an entry.
vec3 brace_segment_depths(BraceTransferEnd front, BraceTransferEnd back) {
  return vec3(brace_optical_depth(front.coordinate),
              4.0 * brace_optical_depth(0.5 * (front.coordinate + back.coordinate)),
              brace_optical_depth(back.coordinate)) * (1.0 / 6.0);
}

float brace_segment_depth(BraceTransferEnd front, BraceTransferEnd back) {
  if (brace_segment_is_short(front, back)) {
    const vec3 depths = brace_segment_depths(front, back);
    return depths.x + depths.y + depths.z;
  }
  return max(brace_segment_sums(front, back).w / (back.coordinate - front.coordinate), 0.0);
}

vec3 brace_segment_mean_colour(BraceTransferEnd front, BraceTransferEnd back) {
  const float middle = 0.5 * (front.coordinate + back.coordinate);
  if (brace_segment_is_short(front, back)) {
    const vec3 depths = brace_segment_depths(front, back);
    const float depth = depths.x + depths.y + depths.z;
    if (!(depth > 0.0)) return brace_transfer_colour(middle);
    return (depths.x / depth) * brace_transfer_colour(front.coordinate) + (depths.y / depth) * brace_transfer_colour(middle) +
           (depths.z / depth) * brace_transfer_colour(back.coordinate);
  }
  const vec4 sums = brace_segment_sums(front, back);
  return abs(sums.w) > 0.0 ? clamp(sums.rgb / sums.w, vec3(0.0), vec3(1.0)) : brace_transfer_colour(middle);
}

#if defined(BRACE_TRANSFER_SEGMENTS)
// Premultiplied colour and opacity of a step from node x to node y; the texel before the first tells the size.
layout(set = 0, binding = BRACE_SLOT_TRANSFER_SEGMENTS) uniform samplerBuffer brace_transfer_segments;

vec3 brace_segment_ordered_colour(BraceTransferEnd front, BraceTransferEnd back) {
  const int size = int(texelFetch(brace_transfer_segments, 0).x);
  const vec2 node = vec2(front.coordinate, back.coordinate) * (float(size - 1) / brace_eye.transfer.z);
  const ivec2 low = min(ivec2(node), ivec2(size - 2));
  const vec2 place = node - vec2(low);
  const int at = 1 + low.y * size + low.x;
  const vec4 front_low = mix(texelFetch(brace_transfer_segments, at), texelFetch(brace_transfer_segments, at + 1), place.x);
  const vec4 front_high =
      mix(texelFetch(brace_transfer_segments, at + size), texelFetch(brace_transfer_segments, at + size + 1), place.x);
  const vec4 step_colour = mix(front_low, front_high, place.y);
  return step_colour.w > 1e-30 ? min(step_colour.rgb / step_colour.w, vec3(1.0)) : brace_segment_mean_colour(front, back);
}
#endif

#endif
