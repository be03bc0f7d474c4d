// One ray per pixel of the eye image, and where a stereo stage asks for them some beside it.
#if defined(BRACE_KERNEL_OPENING)
BraceRay brace_open(uvec2 cell) {
  return brace_ray_through(vec2(cell) - vec2(brace_eye.ray_base.w, brace_eye.ray_dx.w) + 0.5);
}
#endif

#if defined(BRACE_KERNEL_CLOSING)
void brace_close(uvec2 pixel, out vec4 colour, out float depth_m) {
  const uint index = brace_ray_index(pixel + uvec2(brace_eye.ray_base.w, brace_eye.ray_dx.w));
  colour = brace_result_colours[index];
  depth_m = brace_result_depths_m[index];
}
#endif
