// Rays and results: the data between the braces. A ray is cast from where it enters the volume.
#ifndef BRACE_RAY_GLSL
#define BRACE_RAY_GLSL

#include "brace/frame.glsl"

struct BraceRay {
  vec3 entry;      // voxel coordinates of the point where the ray enters the volume (or of the eye inside it)
  float extent;    // from entry to exit, in units; <= 0: the ray misses the volume and is not cast
  vec3 direction;  // voxels per unit: entry + t * direction is t units along the ray
  float level;     // level of detail asked for; 0 is the finest
};

struct BraceResult {
  vec4 colour;  // premultiplied, 0 <= rgb <= a <= 1
  float depth;  // units from entry to the first visible sample, or BRACE_NO_HIT
};

// The ray from an eye in voxel coordinates along a direction in the volume's metric axes, of length 1.
BraceRay brace_ray_from(vec3 eye, vec3 metric) {
  const vec3 direction = metric * brace_eye.voxels_per_unit.xyz;
  const vec3 dims = brace_eye.volume_dims.xyz;
  // An axis that the ray is parallel to gets a tiny slope: no division by zero, hence no 0 * inf.
  const vec3 slope = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  const vec3 to_low = -eye / slope;
  const vec3 to_high = (dims - eye) / slope;
  const vec3 nearer = min(to_low, to_high);
  const vec3 farther = max(to_low, to_high);
  const float begin = max(max(nearer.x, nearer.y), max(nearer.z, 0.0));
  const float end = min(farther.x, min(farther.y, farther.z));
  return BraceRay(clamp(eye + begin * direction, vec3(0.0), dims), max(end - begin, 0.0), direction, 0.0);
}

// The ray through a point of the eye image in pixels; pixel (x, y) has its centre at (x, y) + 0.5.
BraceRay brace_ray_through(vec2 point) {
  return brace_ray_from(brace_eye.eye.xyz, normalize(brace_eye.ray_base.xyz + point.x * brace_eye.ray_dx.xyz +
                                                     point.y * brace_eye.ray_dy.xyz));
}

// Distance in metres from the eye to a point t units along a ray.
float brace_distance_m(BraceRay ray, float t) {
  return (length((ray.entry - brace_eye.eye.xyz) / brace_eye.voxels_per_unit.xyz) + t) * brace_eye.eye.w;
}

#endif
