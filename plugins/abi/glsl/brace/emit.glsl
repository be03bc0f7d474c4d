// The hooks through which a cast stage tells others of the segments it has integrated (stereo re-projection
// layers, warp layers). A stage that wants them defines BRACE_EMIT and the three functions
//   void brace_emit_begin(BraceRay ray)
//   void brace_emit_segment(BraceRay ray, float begin, float end, vec3 colour, float optical_depth)
//   void brace_emit_end(BraceRay ray, float end)
// Segments come front to back, in units from the entry, visible ones only; colour is not premultiplied, the
// segment's transmittance is exp2(-optical_depth). brace_emit_end comes once, also after an early end. One that wants
// to know of rays that miss the volume defines BRACE_EMIT_NOTHING and brace_emit_nothing().
#ifndef BRACE_EMIT_GLSL
#define BRACE_EMIT_GLSL

#if !defined(BRACE_EMIT)
#define brace_emit_begin(ray)
#define brace_emit_segment(ray, begin, end, colour, optical_depth)
#define brace_emit_end(ray, end)
#endif
#if !defined(BRACE_EMIT_NOTHING)
#define brace_emit_nothing()
#endif

#endif
