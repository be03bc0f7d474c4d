// The layers that the warp is made of, for the cast kernel.
#if defined(BRACE_KERNEL_CAST)
#define BRACE_LAYERS_COUNT warp_layers
#define BRACE_LAYERS_SPREAD warp_spread
#define BRACE_LAYERS_GAP_M warp_gap_m
#if defined(BRACE_WARP_LAYERING_EQUAL)
#define BRACE_LAYERS_EQUAL
#endif
#include "brace/layers_emit.glsl"
#else
// The display shows a picture that is warped already.
#define BRACE_WARP_IDENTITY
vec2 brace_warp_source(vec2 tan_xy) { return tan_xy; }
#endif
