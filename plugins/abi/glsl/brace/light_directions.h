/* Where scene.shading = "random_lights" and "shadow_ao" take their additional samples. One text for C, C++
 * and GLSL: a list is written for a macro that makes something of three numbers.
 *
 * random_lights (Buchacher 2017, Fig. 15): parallel lights from random directions, up to four samples towards
 * each. A light's colour are the absolute values of its direction's components. Directions are in the
 * volume's metric axes and of length 1: drawn once, evenly over the sphere (z = 2 u - 1, azimuth 2 pi v, u
 * and v from Python's Random(2017)), so every caster and both eyes have the same.
 *
 * shadow_ao (Fig. 14): samples towards one light, and a ring of them on a sphere: the directions of a cube's
 * faces and corners.
 */
#ifndef BRACE_LIGHT_DIRECTIONS_H
#define BRACE_LIGHT_DIRECTIONS_H

#define BRACE_LIGHTS_MAX 16
#define BRACE_SAMPLES_PER_LIGHT 4
#define BRACE_SHADOW_SAMPLES 24
#define BRACE_OCCLUSION_SAMPLES 14

/* clang-format off */
#define BRACE_LIGHT_DIRECTIONS(V) \
  V(-0.440820, 0.666083, -0.601674), V(-0.931736, -0.063056, -0.357619), V(0.514994, -0.721768, 0.462420), \
  V(0.520932, -0.849539, -0.083151), V(0.474571, -0.427086, -0.769662), V(0.967659, -0.125931, -0.218580), \
  V(0.936576, 0.037946, 0.348404), V(-0.059815, 0.541125, -0.838812), V(0.505334, 0.629707, 0.590006), \
  V(-0.127274, 0.777225, -0.616217), V(-0.839225, -0.112480, -0.532023), V(-0.136733, -0.196076, 0.971009), \
  V(0.608928, -0.762325, -0.219241), V(0.532943, -0.826847, 0.179708), V(0.009942, -0.918933, -0.394288), \
  V(0.613527, -0.542542, 0.573788)

#define BRACE_CORNER 0.577350
#define BRACE_OCCLUSION_DIRECTIONS(V) \
  V(1.0, 0.0, 0.0), V(-1.0, 0.0, 0.0), V(0.0, 1.0, 0.0), V(0.0, -1.0, 0.0), V(0.0, 0.0, 1.0), V(0.0, 0.0, -1.0), \
  V(BRACE_CORNER, BRACE_CORNER, BRACE_CORNER), V(-BRACE_CORNER, BRACE_CORNER, BRACE_CORNER), \
  V(BRACE_CORNER, -BRACE_CORNER, BRACE_CORNER), V(-BRACE_CORNER, -BRACE_CORNER, BRACE_CORNER), \
  V(BRACE_CORNER, BRACE_CORNER, -BRACE_CORNER), V(-BRACE_CORNER, BRACE_CORNER, -BRACE_CORNER), \
  V(BRACE_CORNER, -BRACE_CORNER, -BRACE_CORNER), V(-BRACE_CORNER, -BRACE_CORNER, -BRACE_CORNER)
/* clang-format on */

#endif
