// For warp stages. A stage gives
//   vec2 brace_warp_source(vec2 tan_xy)
// From the direction (tan_xy, -1) in the new eye frame to tangents in the eye frame that the source picture was
// rendered with; BRACE_NO_SOURCE where that picture shows nothing. It is called per pixel and channel. A stage
// that changes nothing says so with #define BRACE_WARP_IDENTITY, and its cost is left out. A stage with work to do
// once per pixel defines BRACE_WARP_PER_PIXEL and gives
//   void brace_warp_pixel(vec2 tan_xy)
// which is called before, with green's direction; what it finds goes into globals of its own. Where it shows
// something else than the picture has there, it sets brace_warp_filled, and the pixel is counted. With
// BRACE_WARP_PER_FOUR beside it, it is called once for four pixels side by side.
#ifndef BRACE_WARP_GLSL
#define BRACE_WARP_GLSL

#include "brace/display_params.h"

#define BRACE_SLOT_DISPLAY 0       // uniform: BraceDisplayParams
#define BRACE_SLOT_SOURCE_IMAGE 1  // texel buffer: a uint per pixel, premultiplied RGBA8, r lowest
#define BRACE_SLOT_PANEL_IMAGE 2   // storage: the same, four pixels at a time
#define BRACE_SLOT_PANEL_TILES 3   // texel buffer: visible tiles, column in the low and row in the high 16 bits
#define BRACE_SLOT_DISPLAY_COUNTERS 4
#define BRACE_SLOT_SOURCE_DEPTH 5  // texel buffer: a float per pixel, metres from the old eye, or BRACE_NO_HIT
// 6 … 13 belong to the warp stage.
#define BRACE_SLOT_CELL_OF_PIXEL 14  // texel buffer: which cell of the eye frame a source pixel was cast in
#define BRACE_SLOT_CELL_POSES 15     // storage: old_from_new and old_from_last of every cell

layout(std140, set = 0, binding = BRACE_SLOT_DISPLAY) uniform BraceDisplayBlock { BraceDisplayParams brace_display; };

bool brace_warp_filled = false;

// Finite, and far outside every picture.
#define BRACE_NO_SOURCE vec2(1e9)

#if defined(BRACE_CELL_POSES)
// Cells of the source picture were cast from poses of their own; the display kernel chooses the cell at hand.
layout(set = 0, binding = BRACE_SLOT_CELL_OF_PIXEL) uniform usamplerBuffer brace_cell_of_pixel;
layout(std430, set = 0, binding = BRACE_SLOT_CELL_POSES) readonly buffer BraceCellPoses { vec4 brace_cell_poses[]; };
uint brace_cell = 0u;
#define BRACE_FIRST_LINE(i) brace_cell_poses[8u * brace_cell + uint(i)].xyz
#define BRACE_LAST_LINE(i) brace_cell_poses[8u * brace_cell + 4u + uint(i)].xyz
#else
#define BRACE_FIRST_LINE(i) brace_display.old_from_new[i].xyz
#define BRACE_LAST_LINE(i) brace_display.old_from_last[i].xyz
#endif

#if defined(BRACE_WARP_SCAN_OUT_LINES)
// How far the scan-out is at the panel pixel at hand: 0 at the first line, 1 at the last. Between their two poses
// the head is taken to move straight, which for the turn of a period is right to 1e-5 of a radian.
float brace_scan = 0.0;
#define BRACE_OLD_FROM_NEW(i) (BRACE_FIRST_LINE(i) + brace_scan * (BRACE_LAST_LINE(i) - BRACE_FIRST_LINE(i)))
#else
#define BRACE_OLD_FROM_NEW(i) BRACE_FIRST_LINE(i)
#endif

// A point given in the new eye frame, in the eye frame of the source picture, metres.
vec3 brace_old_from_new(vec3 point_m) {
  return BRACE_OLD_FROM_NEW(0) * point_m.x + BRACE_OLD_FROM_NEW(1) * point_m.y + BRACE_OLD_FROM_NEW(2) * point_m.z +
         BRACE_OLD_FROM_NEW(3);
}

// Where the new eye is in the eye frame of the source picture, metres.
vec3 brace_new_eye_m() { return BRACE_OLD_FROM_NEW(3); }

#endif
