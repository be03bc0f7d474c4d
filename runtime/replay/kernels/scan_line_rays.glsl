// One ray per pixel of the eye image, from where the eye is when the panel shows it: between its places at the first
// and at the last line of the scan-out.
#if defined(BRACE_KERNEL_OPENING)
layout(std430, set = 0, binding = 24) readonly buffer ScanFractions { float scan_fractions[]; };
layout(std430, set = 0, binding = 25) readonly buffer EyeAtLastLine { BraceEyeParams eye_last; };

BraceRay brace_open(uvec2 cell) {
  const float scan = scan_fractions[brace_ray_index(cell)];
  const vec2 point = vec2(cell) + 0.5;
  const vec3 first = brace_eye.ray_base.xyz + point.x * brace_eye.ray_dx.xyz + point.y * brace_eye.ray_dy.xyz;
  const vec3 last = eye_last.ray_base.xyz + point.x * eye_last.ray_dx.xyz + point.y * eye_last.ray_dy.xyz;
  return brace_ray_from(mix(brace_eye.eye.xyz, eye_last.eye.xyz, scan), normalize(mix(first, last, scan)));
}
#endif

#if defined(BRACE_KERNEL_CLOSING)
void brace_close(uvec2 pixel, out vec4 colour, out float depth_m) {
  const uint index = brace_ray_index(pixel);
  colour = brace_result_colours[index];
  depth_m = brace_result_depths_m[index];
}
#endif
