// For skip stages that know empty cubes of blocks: where a sample lies, and how far it may leap.
#ifndef BRACE_SKIP_GRID_GLSL
#define BRACE_SKIP_GRID_GLSL

#include "brace/ray.glsl"
#include "brace/skip_params.h"

#define BRACE_SLOT_SKIP_MAP 10     // texel buffer of 32-bit words: distances, bits or nodes
#define BRACE_SLOT_SKIP_PARAMS 11  // uniform: BraceSkipParams

layout(set = 0, binding = BRACE_SLOT_SKIP_MAP) uniform usamplerBuffer brace_skip_words;
layout(std140, set = 0, binding = BRACE_SLOT_SKIP_PARAMS) uniform BraceSkipBlock { BraceSkipParams brace_skip_params; };
// Read once, as brace_eye is.
vec4 brace_skip_edge = brace_skip_params.edge;
ivec3 brace_skip_last = ivec3(brace_skip_params.blocks.xyz) - 1;

// The block of a point. Blocks know their surroundings half a voxel beyond their faces, so rounding does no harm.
ivec3 brace_skip_block(vec3 voxel) {
  return clamp(ivec3(voxel * brace_skip_edge.y), ivec3(0), brace_skip_last);
}

#if defined(BRACE_VOLUME_LEVELS)
// How near to something visible samples may not be leapt over: coarse voxels have their parts from that far away.
// Voxels; the cast stage sets it.
#define BRACE_SKIP_MARGIN
float brace_skip_margin = 0.0;
#endif

// Steps of the lattice from a sample at `voxel` to the first one beyond the cube of voxels [low, high]; at least 1.
// The samples between lie inside or, by rounding, a hair beyond a face, which blocks know half a voxel of.
int brace_skip_leap(BraceRay ray, vec3 voxel, vec3 low, vec3 high, float step) {
#if defined(BRACE_SKIP_MARGIN)
  low += brace_skip_margin;
  high -= brace_skip_margin;
  if (any(lessThan(voxel, low)) || any(greaterThan(voxel, high))) return 1;
#endif
  const vec3 face = mix(low, high, greaterThan(ray.direction, vec3(0.0)));
  // A ray parallel to an axis never leaves along it.
  const bvec3 still = lessThan(abs(ray.direction), vec3(1e-20));
  const vec3 away = mix((face - voxel) / mix(ray.direction, vec3(1.0), still), vec3(1e9), still);
  return 1 + max(0, int(min(min(away.x, min(away.y, away.z)) * (1.0 / step), 1048576.0)));
}

// The same from the distance in blocks to the nearest occupied block: all that are nearer are empty.
int brace_skip_leap_distance(BraceRay ray, vec3 voxel, ivec3 block, int distance, float step) {
  const float edge = brace_skip_edge.x;
  return brace_skip_leap(ray, voxel, vec3(block + 1 - distance) * edge, vec3(block + distance) * edge, step);
}

#endif
