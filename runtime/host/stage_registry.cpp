#include "runtime/host/stage_registry.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.hpp"
#include "base/suggest.hpp"

namespace brace {

const std::vector<std::string>& stage_families() {
  static const std::vector<std::string> families = {"rays", "cast",    "skip",    "stereo", "schedule",
                                                    "warp", "control", "predict", "cost"};
  return families;
}

double PipelineStage::value(std::string_view parameter) const {
  for (std::size_t i = 0; i < stage.parameters.size(); ++i) {
    if (stage.parameters[i].name == parameter) return values[i];
  }
  throw device_error("stage {} has no parameter '{}'", stage.id(), parameter);
}

bool PipelineStage::set(std::string_view parameter, double value) {
  for (std::size_t i = 0; i < stage.parameters.size(); ++i) {
    if (stage.parameters[i].name != parameter) continue;
    values[i] = value;
    return true;
  }
  return false;
}

bool PipelineStage::set_choice(std::string_view parameter, std::string_view choice) {
  for (const StageParameter& known : stage.parameters) {
    if (known.name != parameter) continue;
    const auto at = std::find(known.choices.begin(), known.choices.end(), choice);
    return at != known.choices.end() && set(parameter, static_cast<double>(at - known.choices.begin()));
  }
  return false;
}

void StageRegistry::add(StageInfo stage) {
  for (const StageInfo& other : stages_) {
    if (other.family != stage.family || other.name != stage.name) continue;
    const auto where = [](const StageInfo& s) {
      return s.origin.empty() ? std::string("built in") : s.origin.string();
    };
    throw input_error("stage {} is there twice: {} and {}; rename one", stage.id(), where(other),
                      where(stage));
  }
  stages_.push_back(std::move(stage));
}

void StageRegistry::add(const brace_stage_descriptor& descriptor, const std::filesystem::path& origin) {
  add(stage_info(descriptor, origin));
}

void StageRegistry::add_folder(const std::filesystem::path& folder) {
  std::set<std::filesystem::path> manifests;
  std::error_code ignored;
  for (const auto& family : std::filesystem::directory_iterator(folder, ignored)) {
    if (!family.is_directory()) continue;
    for (const auto& stage : std::filesystem::directory_iterator(family.path(), ignored)) {
      const std::filesystem::path manifest = stage.path() / "stage.toml";
      if (std::filesystem::is_regular_file(manifest, ignored)) manifests.insert(manifest);
    }
  }
  for (const auto& manifest : manifests)
    add(read_stage_manifest(manifest));
}

std::vector<std::string> StageRegistry::names(std::string_view family) const {
  std::vector<std::string> names;
  for (const StageInfo& stage : stages_) {
    if (stage.family == family) names.push_back(stage.name);
  }
  return names;
}

const StageInfo& StageRegistry::find(std::string_view family, std::string_view name,
                                     const std::string& place) const {
  for (const auto& [id, why] : missing_) {
    if (id == fmt::format("{}/{}", family, name)) throw device_error("{}: {}", place, why);
  }
  for (const StageInfo& stage : stages_) {
    if (stage.family == family && stage.name == name) return stage;
  }
  const std::vector<std::string> known = names(family);
  const std::string unknown =
      fmt::format("{}: unknown stage '{}/{}'{}; there are: {}", place, family, name,
                  did_you_mean(name, known), known.empty() ? "none of this family" : join(known));
  std::string left_out;
  for (const auto& [id, why] : missing_) {
    if (id.empty()) left_out += fmt::format("\n  not loaded: {}", why);
  }
  if (!left_out.empty()) throw device_error("{}{}", unknown, left_out);
  throw input_error("{}", unknown);
}

void check_parameter_value(const StageInfo& stage, const StageParameter& parameter, double value,
                           const std::string& place) {
  const bool in_range = value >= parameter.minimum && value <= parameter.maximum;  // false for NaN
  const bool whole = parameter.type == ParameterType::floating || value == std::floor(value);
  if (in_range && whole) return;
  throw input_error("{}: {} = {} of stage {} is out of range; accepted: {}{} to {}{}{}", place,
                    parameter.name, value, stage.id(),
                    parameter.type == ParameterType::floating ? "" : "whole numbers ", parameter.minimum,
                    parameter.maximum, parameter.unit.empty() ? "" : " ", parameter.unit);
}

namespace {

ParameterType parameter_type(std::uint32_t type) {
  switch (type) {
    case BRACE_PARAM_BOOL:
      return ParameterType::boolean;
    case BRACE_PARAM_INT:
      return ParameterType::integer;
    case BRACE_PARAM_FLOAT:
      return ParameterType::floating;
    case BRACE_PARAM_CHOICE:
      return ParameterType::choice;
  }
  throw input_error("parameter type {} is not one of bool, int, float, choice", type);
}

std::string text_or_empty(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

StageParameter stage_parameter(const brace_param& param) {
  StageParameter out;
  out.name = text_or_empty(param.name);
  out.type = parameter_type(param.type);
  out.unit = text_or_empty(param.unit);
  out.help = text_or_empty(param.help);
  out.minimum = param.minimum;
  out.maximum = param.maximum;
  out.default_value = param.default_value;
  if (out.type == ParameterType::choice) {
    for (const char* const* choice = param.choices; choice != nullptr && *choice != nullptr; ++choice) {
      out.choices.emplace_back(*choice);
    }
    out.minimum = 0.0;
    out.maximum = static_cast<double>(out.choices.size()) - 1.0;
  }
  if (out.type == ParameterType::boolean) {
    out.minimum = 0.0;
    out.maximum = 1.0;
  }
  return out;
}

bool gives_segments(const brace_stage_descriptor& descriptor) {
  if (descriptor.kind != BRACE_KIND_CAST || descriptor.functions == nullptr) return false;
  const auto& cast = *static_cast<const brace_cast_functions*>(descriptor.functions);
  return cast.execute != nullptr && cast.gives_segments != 0;
}

}  // namespace

StageInfo stage_info(const brace_stage_descriptor& descriptor, const std::filesystem::path& origin) {
  const std::string place = origin.empty() ? std::string("built-in stage") : origin.string();
  const auto index = static_cast<std::size_t>(descriptor.kind) - 1;
  // The enum follows stage_families() one to one; cost comes last in both.
  if (index >= stage_families().size()) {
    throw input_error("{}: stage kind {} is unknown; accepted: 1 to {}", place,
                      static_cast<int>(descriptor.kind), stage_families().size());
  }
  StageInfo info;
  info.family = stage_families()[index];
  info.name = text_or_empty(descriptor.name);
  info.version = text_or_empty(descriptor.version);
  info.help = text_or_empty(descriptor.help);
  info.origin = origin;
  info.native = &descriptor;
  if (info.name.empty()) throw input_error("{}: a stage of family {} has no name", place, info.family);
  for (std::uint32_t i = 0; i < descriptor.param_count; ++i) {
    info.parameters.push_back(stage_parameter(descriptor.params[i]));
    check_parameter_value(info, info.parameters.back(), info.parameters.back().default_value,
                          place + " (default)");
  }
  if (gives_segments(descriptor)) info.outputs.emplace_back("segments");
  return info;
}

}  // namespace brace
