// What is bound to every kernel, and the slots of all bindings. Set 0.
#ifndef BRACE_FRAME_GLSL
#define BRACE_FRAME_GLSL

#include "brace/eye_params.h"

#define BRACE_SLOT_EYE 0             // uniform: BraceEyeParams
#define BRACE_SLOT_RAY_ENTRY 1       // storage: vec4 per ray
#define BRACE_SLOT_RAY_DIRECTION 2   // storage: vec4 per ray
#define BRACE_SLOT_RESULT_COLOUR 3   // storage: vec4 per ray
#define BRACE_SLOT_RESULT_DEPTH 4    // storage: float per ray
#define BRACE_SLOT_VOLUME 5          // texel buffer or 3D sampler
#define BRACE_SLOT_TRANSFER 6        // texel buffer: the transfer table, see transfer_function.glsl
#define BRACE_SLOT_COUNTERS 7        // storage: see counters.glsl
#define BRACE_SLOT_EYE_IMAGE 8       // storage: uint per pixel, packed RGBA8
#define BRACE_SLOT_EYE_DEPTH 9       // storage: float per pixel
#define BRACE_SLOT_TRANSFER_INTEGRALS 40  // texel buffer: see transfer_integral.glsl
#define BRACE_SLOT_TRANSFER_SEGMENTS 41   // texel buffer: the two-dimensional table of the same
// 42 and 43 are those of levels.glsl.
#define BRACE_SLOT_SEGMENT_HEADS 44  // storage: what rays leave, where a cast on the host tells
#define BRACE_SLOT_SEGMENTS 45       // storage: six floats per segment (brace_segment)
// 10 … 15 belong to the skip stage, 16 … 23 to the stereo stage, 24 … 31 to the rays stage, 32 … 39 to the warp stage.

layout(std140, set = 0, binding = BRACE_SLOT_EYE) uniform BraceEyeBlock { BraceEyeParams brace_eye_block; };
// Read once, at the start of an invocation: a software device fetches a uniform lane by lane wherever it is named, and
// takes none out of a loop.
BraceEyeParams brace_eye = brace_eye_block;
layout(push_constant) uniform BraceAreaBlock { BraceArea brace_area; };

// Depth of a ray that meets nothing visible: +infinity.
#define BRACE_NO_HIT uintBitsToFloat(0x7f800000u)

#endif
