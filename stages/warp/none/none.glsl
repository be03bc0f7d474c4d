// No warp: the panel shows the picture from the pose it was rendered with.
#define BRACE_WARP_IDENTITY
vec2 brace_warp_source(vec2 tan_xy) { return tan_xy; }
