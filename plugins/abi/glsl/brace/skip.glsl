// The hook of the skip stages. A skip stage that skips defines BRACE_SKIP and
//   int brace_skip(BraceRay ray, vec3 voxel, int i, float step)
// : how many lattice steps to go on from the transparent sample i at `voxel`, at least 1. It is asked after a
// transparent sample only, and the samples it leaps over must be transparent too: the picture stays the same
// bit for bit. Without it a transparent sample is followed by the next one.
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
#define BRACE_COUNT_VISIT
#define BRACE_COUNT_VISITED(i) BRACE_COUNT(samples, uint(i))
#endif

#endif
