// Lighting of a visible sample: brace_shade(ray, voxel, colour). Without BRACE_SHADING_PHONG it is the colour
// itself and leaves nothing behind in the kernel.
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
#else
#define brace_shade(ray, voxel, colour) (colour)
#define BRACE_SHADE_FETCHES 0u
#endif

#endif
