// Called per pixel and colour channel with the direction (tan_xy, -1) in the eye frame of the newest pose. Gives
// tangents in the eye frame that the picture was rendered with, or BRACE_NO_SOURCE where it shows nothing.
vec2 brace_warp_source(vec2 tan_xy) {
  const vec3 direction = vec3(tan_xy, -1.0);
  const vec3 turned = brace_display.old_from_new[0].xyz * direction.x + brace_display.old_from_new[1].xyz * direction.y +
                      brace_display.old_from_new[2].xyz * direction.z;
  if (turned.z > -1e-3) return BRACE_NO_SOURCE;  // beside or behind the old eye
  return mix(tan_xy, turned.xy / -turned.z, warp_strength);
}
