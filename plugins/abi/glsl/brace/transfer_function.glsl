// The transfer function as a table; runtime/volume/transfer_function.hpp defines the lookup. The host bakes
// the step of the session into it: w is the optical depth of one full step in powers of two, so that the
// transmittance of a step is exp2(-w).
#ifndef BRACE_TRANSFER_FUNCTION_GLSL
#define BRACE_TRANSFER_FUNCTION_GLSL

#include "brace/frame.glsl"

// Per entry: r, g, b not premultiplied; optical depth. A texel buffer: a software device reads an entry at once, a
// uniform it would read component by component and lane by lane; a GPU's constant cache serves one address at a time.
layout(set = 0, binding = BRACE_SLOT_TRANSFER) uniform samplerBuffer brace_transfer_entries;

// The table coordinate of a value, not clamped yet. Up to brace_eye.transfer.w everything is fully transparent.
float brace_transfer_coordinate(float value) { return value * brace_eye.transfer.x + brace_eye.transfer.y; }

int brace_transfer_entry(float coordinate, out float place) {
  const float clamped = clamp(coordinate, 0.0, brace_eye.transfer.z);
  const int entry = min(int(clamped), int(brace_eye.transfer.z) - 1);
  place = clamped - float(entry);
  return entry;
}

// What the table has at a coordinate: colour, not premultiplied, and optical depth of one full step.
vec4 brace_transfer(float coordinate) {
  float place;
  const int entry = brace_transfer_entry(coordinate, place);
  const vec4 low = texelFetch(brace_transfer_entries, entry);
  return low + place * (texelFetch(brace_transfer_entries, entry + 1) - low);
}

// Optical depth of one full step at a table coordinate; transmittance is exp2(-depth).
float brace_optical_depth(float coordinate) { return brace_transfer(coordinate).w; }

// Colour at a table coordinate, not premultiplied.
vec3 brace_transfer_colour(float coordinate) { return brace_transfer(coordinate).rgb; }

#endif
