// The layers that the right eye's picture is made of, for the cast kernel.
#define BRACE_LAYERS_COUNT stereo_layers
#define BRACE_LAYERS_SPREAD stereo_spread
#define BRACE_LAYERS_GAP_M stereo_gap_m
#include "brace/layers_emit.glsl"
