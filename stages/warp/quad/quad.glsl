// The eye frame as a quad at the far plane of the new view, looked up in the old one: old projection * old view *
// inverse(new view) * far-plane point (Buchacher 2017, Sources 2 and 3). In tangents the projections drop out.
// The translation between the poses counts as much as it does at that distance.
vec2 brace_warp_source(vec2 tan_xy) {
  const vec3 old_m = brace_old_from_new(vec3(tan_xy, -1.0) * warp_far_plane_m);
  // Beside or behind the old camera there is no picture; 1e-4 keeps the quotient finite.
  const float distance_m = -old_m.z;
  const bool in_front = distance_m > 1e-4 * warp_far_plane_m;
  return in_front ? old_m.xy / max(distance_m, 1e-4 * warp_far_plane_m) : BRACE_NO_SOURCE;
}
