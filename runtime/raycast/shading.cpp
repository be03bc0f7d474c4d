#include "runtime/raycast/shading.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "plugins/abi/glsl/brace/light_directions.h"

namespace brace {

std::vector<std::pair<std::string, std::string>> defines(const SampledShading& shading) {
  using Kind = SampledShading::Kind;
  if (shading.kind == Kind::none) return {};
  BRACE_CHECK(shading.samples >= 0 && shading.samples <= BRACE_LIGHTS_MAX * BRACE_SAMPLES_PER_LIGHT);
  const glm::dvec3& light = shading.light;
  std::vector<std::pair<std::string, std::string>> all = {
      {"BRACE_SHADE_STEP", fmt::format("{:.9e}", shading.step_units)},
      {"BRACE_SHADE_DEPTH", fmt::format("{:.9e}", shading.steps_of_table)}};
  if (shading.kind == Kind::random_lights) {
    all.emplace_back("BRACE_SHADING_RANDOM_LIGHTS", "1");
    all.emplace_back("BRACE_SHADE_SAMPLES", fmt::format("{}", shading.samples));
  } else {
    all.emplace_back("BRACE_SHADING_SHADOW_AO", "1");
    all.emplace_back("BRACE_SHADE_LIGHT",
                     fmt::format("vec3({:.9e}, {:.9e}, {:.9e})", light.x, light.y, light.z));
  }
  return all;
}

}  // namespace brace
