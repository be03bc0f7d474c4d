// The opening and the closing brace: rays for the raycaster, and the picture from what became of them. The ray
// grid has brace_eye.grid.xy rays, the picture brace_eye.grid.zw pixels.

#if defined(BRACE_KERNEL_OPENING)
// The ray of a cell of the grid. brace_ray_through(point) gives the ray through a point of the picture in
// pixels; a ray with extent 0 is not cast.
BraceRay brace_open(uvec2 cell) { return brace_ray_through(vec2(cell) + 0.5); }
#endif

#if defined(BRACE_KERNEL_CLOSING)
// Premultiplied colour, and metres to the first visible sample or BRACE_NO_HIT.
void brace_close(uvec2 pixel, out vec4 colour, out float depth_m) {
  const uint index = brace_ray_index(pixel);
  colour = brace_result_colours[index];
  depth_m = brace_result_depths_m[index];
}
#endif
