#pragma once

#include <string>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

namespace brace {

/// Lighting by additional samples of the volume (brace/shade.glsl; Buchacher 2017, Figs. 14 and 15).
struct SampledShading {
  enum class Kind {
    none,
    shadow_ao,     // 24 samples towards a light, 14 around
    random_lights  // up to four towards each of several lights
  } kind = Kind::none;
  int samples = 16;                 // of random_lights, 0 to 64
  double step_units = 1.0;          // between them along a direction; how far around shadow_ao looks
  double steps_of_table = 2.0;      // such a step over the step that the transfer table has baked in
  glm::dvec3 light{0.0, 1.0, 0.0};  // of shadow_ao: towards it, volume's metric axes, length 1
};

/// Macros for cast kernels.
std::vector<std::pair<std::string, std::string>> defines(const SampledShading& shading);

}  // namespace brace
