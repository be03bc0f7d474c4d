// The hook of the skip stages. A skip stage that skips defines BRACE_SKIP and
//   int brace_skip(BraceRay ray, vec3 voxel, int i, float step)
// : how many lattice steps to go on from the transparent sample i at `voxel`, at least 1. It is asked after a
// transparent sample only, and the samples it leaps over must be transparent too: the picture stays the same
// bit for bit. Without it a transparent sample is followed by the next one.
// One that knows where rays may begin defines BRACE_SKIP_BEGIN and
//   int brace_skip_begin(BraceRay ray, float place, float step, float gap, inout uint looks)
// : how many samples t = (i + place) step at the ray's begin are transparent. `gap` is how far in front of a
// depth that the cast stage tells something may already be visible, in units; `looks` counts look-ups. A cast stage
// asks with BRACE_BEGIN_RAY after i = 0.
// Samples are counted one by one with BRACE_COUNT_VISIT where there is skipping; else BRACE_COUNT_VISITED(i)
// counts them all at the end of the ray.
#ifndef BRACE_SKIP_GLSL
#define BRACE_SKIP_GLSL

#include "brace/counters.glsl"

#if defined(BRACE_SKIP)
#define BRACE_NEXT_SAMPLE(ray, voxel, i, step) (i) += brace_skip(ray, voxel, i, step); BRACE_COUNT(skip_steps, 1u)
#define BRACE_COUNT_VISIT BRACE_COUNT(samples, 1u)
#define BRACE_COUNT_VISITED(i)
#else
#define BRACE_NEXT_SAMPLE(ray, voxel, i, step) (i) += 1
#if defined(BRACE_SKIP_BEGIN)
#define BRACE_COUNT_VISIT BRACE_COUNT(samples, 1u)
#define BRACE_COUNT_VISITED(i)
#else
#define BRACE_COUNT_VISIT
#define BRACE_COUNT_VISITED(i) BRACE_COUNT(samples, uint(i))
#endif
#endif

#if defined(BRACE_SKIP_BEGIN)
#define BRACE_BEGIN_RAY(ray, i, place, step, gap) \
  uint brace_looks = 0u; \
  (i) = brace_skip_begin(ray, place, step, gap, brace_looks); \
  BRACE_COUNT(skip_steps, brace_looks)
#else
#define BRACE_BEGIN_RAY(ray, i, place, step, gap)
#endif

#endif
