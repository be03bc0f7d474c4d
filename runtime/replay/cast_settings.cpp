#include "runtime/replay/cast_settings.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace brace {

namespace {

bool has_parameter(const StageInfo& stage, const std::string& parameter) {
  return std::any_of(stage.parameters.begin(), stage.parameters.end(),
                     [&](const StageParameter& one) { return one.name == parameter; });
}

}  // namespace

std::vector<std::pair<std::string, double>> settings_for(const PipelineStage& told, const StageInfo& other) {
  std::vector<std::pair<std::string, double>> settings;
  for (std::size_t i = 0; i < told.values.size(); ++i) {
    const StageParameter& parameter = told.stage.parameters[i];
    if (told.values[i] == parameter.default_value) continue;
    if (!has_parameter(other, parameter.name) || parameter.type == ParameterType::choice)
      throw input_error("{} has no setting '{}', which the session sets", other.id(), parameter.name);
    settings.emplace_back(parameter.name, told.values[i]);
  }
  return settings;
}

}  // namespace brace
