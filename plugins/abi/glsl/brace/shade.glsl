// Lighting of a visible sample: brace_shade(ray, voxel, colour). Without shading it is the colour itself and leaves
// nothing behind in the kernel; what there is, the host defines:
//   BRACE_SHADING_PHONG          local illumination by the gradient
//   BRACE_SHADING_SHADOW_AO      samples towards a light and around: shadow and ambient occlusion
//   BRACE_SHADING_RANDOM_LIGHTS  samples towards lights from random directions
// BRACE_SHADE_FETCHES is how often it looks into the volume.
#ifndef BRACE_SHADE_GLSL
#define BRACE_SHADE_GLSL

#if defined(BRACE_SHADING_PHONG)

#include "brace/gradient.glsl"
#include "brace/ray.glsl"

// The stage that includes this has the parameters cast_ambient, cast_diffuse, cast_specular, cast_shininess.
// Gradients below this share of the table's range per unit are seen as noise, not as surfaces: there the
// sample keeps its own colour. The blend is continuous, so rounding cannot flip a pixel.
#define BRACE_SHADE_FLAT 1e-3

// Blinn-Phong with the light at the eye (light, view and half vector are one), both sides of a surface lit.
vec3 brace_shade(BraceRay ray, vec3 voxel, vec3 colour) {
  const vec3 gradient = brace_gradient(voxel) * brace_eye.transfer.x / brace_eye.transfer.z;  // in table ranges
  const vec3 view = ray.direction / brace_eye.voxels_per_unit.xyz;  // unit vector
  const float size = length(gradient);
  const float along = abs(dot(gradient, view));
  const float facing = min((along + BRACE_SHADE_FLAT) / (size + BRACE_SHADE_FLAT), 1.0);
  const float glint = cast_specular * pow(facing, cast_shininess) * size / (size + BRACE_SHADE_FLAT);
  return min(colour * (cast_ambient + cast_diffuse * facing) + glint, vec3(1.0));
}

#define BRACE_SHADE_FETCHES BRACE_GRADIENT_FETCHES
#elif defined(BRACE_SHADING_SHADOW_AO) || defined(BRACE_SHADING_RANDOM_LIGHTS)

// The host defines as well, all for additional samples:
//   BRACE_SHADE_STEP     from one to the next along a direction, in units
//   BRACE_SHADE_DEPTH    optical depth of such a step over that of a step of the table
//   BRACE_SHADE_LIGHT    shadow_ao: towards the light, in the volume's metric axes, of length 1
//   BRACE_SHADE_SAMPLES  random_lights: how many
#include "brace/light_directions.h"
#include "brace/ray.glsl"
#include "brace/transfer_function.glsl"
#include "brace/volume.glsl"

// Optical depth, in powers of two, of a step around a point; nothing outside of the volume, or where it is NaN.
float brace_shade_depth(vec3 voxel) {
  const bool inside =
      all(greaterThanEqual(voxel, vec3(0.0))) && all(lessThanEqual(voxel, brace_eye.volume_dims.xyz));
  const float depth = BRACE_SHADE_DEPTH * brace_optical_depth(brace_transfer_coordinate(brace_volume(voxel)));
  return inside && depth > 0.0 ? depth : 0.0;
}

float brace_shade_depth_towards(vec3 voxel, vec3 direction, int samples) {
  const vec3 stride = BRACE_SHADE_STEP * direction * brace_eye.voxels_per_unit.xyz;
  float depth = 0.0;
  for (int i = 1; i <= samples; ++i) depth += brace_shade_depth(voxel + float(i) * stride);
  return depth;
}

#if defined(BRACE_SHADING_SHADOW_AO)

const vec3 brace_around[BRACE_OCCLUSION_SAMPLES] = vec3[](BRACE_OCCLUSION_DIRECTIONS(vec3));

vec3 brace_shade(BraceRay ray, vec3 voxel, vec3 colour) {
  const float lit = exp2(-brace_shade_depth_towards(voxel, BRACE_SHADE_LIGHT, BRACE_SHADOW_SAMPLES));
  float open = 0.0;
  for (int i = 0; i < BRACE_OCCLUSION_SAMPLES; ++i)
    open += exp2(-brace_shade_depth_towards(voxel, brace_around[i], 1));
  return colour * lit * (open / float(BRACE_OCCLUSION_SAMPLES));
}

#define BRACE_SHADE_FETCHES uint(BRACE_SHADOW_SAMPLES + BRACE_OCCLUSION_SAMPLES)
#else

const vec3 brace_lights[BRACE_LIGHTS_MAX] = vec3[](BRACE_LIGHT_DIRECTIONS(vec3));
const int brace_light_count = max((BRACE_SHADE_SAMPLES + BRACE_SAMPLES_PER_LIGHT - 1) / BRACE_SAMPLES_PER_LIGHT, 1);

vec3 brace_shade(BraceRay ray, vec3 voxel, vec3 colour) {
  vec3 light = vec3(0.0);
  for (int i = 0; i < brace_light_count; ++i) {
    const vec3 towards = brace_lights[i];
    const int samples = min(BRACE_SAMPLES_PER_LIGHT, BRACE_SHADE_SAMPLES - BRACE_SAMPLES_PER_LIGHT * i);
    light += abs(towards) * exp2(-brace_shade_depth_towards(voxel, towards, samples));
  }
  return colour * light / float(brace_light_count);
}

#define BRACE_SHADE_FETCHES uint(BRACE_SHADE_SAMPLES)
#endif

#else
#define brace_shade(ray, voxel, colour) (colour)
#define BRACE_SHADE_FETCHES 0u
#endif

#endif
