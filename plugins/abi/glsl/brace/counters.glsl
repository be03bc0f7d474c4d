// Counted work, composed in with BRACE_COUNTERS; without it the macros leave nothing behind.
//   BRACE_COUNTERS_DECLARE          at the start of a hook
//   BRACE_COUNT(samples, 1u)        rays, samples, skip_steps, shading_fetches
//   BRACE_COUNTERS_COMMIT           at its end
// Counts are exact 64-bit sums. They are spread over rows so that work-groups do not wait for each other.
#ifndef BRACE_COUNTERS_GLSL
#define BRACE_COUNTERS_GLSL

#if defined(BRACE_COUNTERS)

#include "brace/frame.glsl"

#define BRACE_COUNTER_ROWS 64u
// Per row: low and high word of rays, samples, skip_steps, shading_fetches.
layout(std430, set = 0, binding = BRACE_SLOT_COUNTERS) buffer BraceCounterBlock { uint brace_counters[]; };

void brace_count_add(uint counter, uint amount) {
  if (amount == 0u) return;
  const uint row = (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) % BRACE_COUNTER_ROWS;
  const uint at = row * 8u + counter * 2u;
  const uint before = atomicAdd(brace_counters[at], amount);
  if (before + amount < before) atomicAdd(brace_counters[at + 1u], 1u);
}

#define BRACE_COUNTERS_DECLARE uint brace_count_rays = 1u, brace_count_samples = 0u, brace_count_skip_steps = 0u, brace_count_shading_fetches = 0u;
#define BRACE_COUNT(counter, amount) brace_count_##counter += (amount)
#if defined(BRACE_RAY_HEAT)
uint brace_ray_heat = 0u;  // the count that BRACE_RAY_HEAT names, of this ray
#define BRACE_COUNTERS_KEEP ; brace_ray_heat = BRACE_RAY_HEAT
#else
#define BRACE_COUNTERS_KEEP
#endif
#define BRACE_COUNTERS_COMMIT brace_count_add(0u, brace_count_rays); brace_count_add(1u, brace_count_samples); brace_count_add(2u, brace_count_skip_steps); brace_count_add(3u, brace_count_shading_fetches) BRACE_COUNTERS_KEEP

#else
#define BRACE_COUNTERS_DECLARE
#define BRACE_COUNT(counter, amount)
#define BRACE_COUNTERS_COMMIT
#endif

#endif
