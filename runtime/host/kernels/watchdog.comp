#version 460
// Counts results of rays that break the contract of brace/ray.glsl. Bits are looked at instead of values where
// a compiler may assume that there are no NaNs.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Colours { uvec4 colours[]; };
layout(std430, set = 0, binding = 1) readonly buffer Depths { uint depths_m[]; };
layout(std430, set = 0, binding = 2) buffer Counts { uint counts[4]; };  // WatchdogClause
layout(push_constant) uniform Work { uint rays; };

const uint infinity = 0x7f800000u;
const float slack = 1e-6;  // rounding of a stage that computes colour and opacity apart

bool finite(uint bits) { return (bits & infinity) != infinity; }

void main() {
  const uint ray = gl_GlobalInvocationID.x;
  if (ray >= rays) return;
  const uvec4 bits = colours[ray];
  const uint depth = depths_m[ray];
  if (!finite(bits.x) || !finite(bits.y) || !finite(bits.z) || !finite(bits.w) || (!finite(depth) && depth != infinity)) {
    atomicAdd(counts[0], 1u);
    return;
  }
  const vec4 colour = uintBitsToFloat(bits);
  if (any(lessThan(colour.rgb, vec3(-slack))) || any(greaterThan(colour.rgb, vec3(colour.a + slack)))) {
    atomicAdd(counts[1], 1u);
  }
  if (colour.a < -slack || colour.a > 1.0 + slack) atomicAdd(counts[2], 1u);
  if (uintBitsToFloat(depth) < 0.0) atomicAdd(counts[3], 1u);
}
