// A warp that extrapolates: the head has turned by R since the picture was rendered and goes on turning while the
// panel lights up, so the picture is looked up for R^(1 + beyond). Rotation only: what is looked up lies at
// infinity.

// The rotation vector of old_from_new (axis times angle), after Rodrigues.
vec3 turn_rad() {
  const mat3 m = mat3(brace_display.old_from_new[0].xyz, brace_display.old_from_new[1].xyz, brace_display.old_from_new[2].xyz);
  // Twice the sine of the angle times the axis; m is column-major.
  const vec3 twice = vec3(m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]);
  const float sine = 0.5 * length(twice);
  const float cosine = 0.5 * (m[0][0] + m[1][1] + m[2][2] - 1.0);
  // Towards a half turn the axis is lost: such a turn is not extrapolated, see below.
  return sine > 1e-6 ? twice * (0.5 * atan(sine, cosine) / sine) : 0.5 * twice;
}

vec3 rotated(vec3 v, vec3 rotation) {
  const float angle = length(rotation);
  if (angle < 1e-7) return v;
  const vec3 axis = rotation / angle;
  return v * cos(angle) + cross(axis, v) * sin(angle) + axis * dot(axis, v) * (1.0 - cos(angle));
}

vec2 brace_warp_source(vec2 tan_xy) {
  const vec3 at_newest = brace_old_from_new(vec3(tan_xy, -1.0)) - brace_display.old_from_new[3].xyz;
  const vec3 turn = turn_rad();
  // A turn of more than half a radian within a frame is a jump of the tracker, not a motion that goes on.
  const vec3 old = length(turn) < 0.5 ? rotated(at_newest, warp_beyond * turn) : at_newest;
  return old.z < -1e-4 ? old.xy / -old.z : BRACE_NO_SOURCE;
}
