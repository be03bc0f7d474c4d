// Four 7-bit numbers in a word. Distances are clamped to 127 so that the highest bit is free: a minimum of four
// takes six operations. The second argument may be 128 in any byte.
#ifndef BRACE_SKIP_BYTES_GLSL
#define BRACE_SKIP_BYTES_GLSL

#define BRACE_FAR 0x7f7f7f7fu
#define BRACE_FREE_BITS 0x80808080u

uint min_bytes(uint a, uint b) {
  const uint difference = (a | 0x80808080u) - b;  // per byte 128 + a - b, never a borrow
  const uint not_below = difference & 0x80808080u;
  return a - (difference & (not_below - (not_below >> 7)));
}

uvec4 min_bytes(uvec4 a, uvec4 b) {
  return uvec4(min_bytes(a.x, b.x), min_bytes(a.y, b.y), min_bytes(a.z, b.z), min_bytes(a.w, b.w));
}

// The same with the free bits of `a` set, and of the result: an operation less in a chain of minima.
uvec4 nearer_bytes(uvec4 a, uvec4 b) {
  const uvec4 difference = a - b;
  const uvec4 not_below = difference & BRACE_FREE_BITS;
  return a - (difference & (not_below - (not_below >> 7)));
}

// Of each byte and its two neighbours along x; `left` and `right` are the words beyond.
uvec4 min_of_three(uint left, uvec4 middle, uint right) {
  const uvec4 from_left = (middle << 8) | (uvec4(left, middle.xyz) >> 24);
  const uvec4 from_right = (middle >> 8) | (uvec4(middle.yzw, right) << 24);
  return min_bytes(middle, min_bytes(from_left, from_right));
}

#endif
