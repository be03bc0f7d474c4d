#include "runtime/host/stage_glsl.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr std::uint32_t kParametersPerStage = 64;

std::uint32_t first_constant_id(const std::string& family) {
  const auto& families = stage_families();
  const auto at = std::find(families.begin(), families.end(), family);
  BRACE_CHECK(at != families.end());
  return static_cast<std::uint32_t>(at - families.begin()) * kParametersPerStage;
}

gpu::SpecConstant constant(std::uint32_t id, const StageParameter& parameter, double value) {
  switch (parameter.type) {
    case ParameterType::boolean:
      return gpu::spec_constant(id, value != 0.0);
    case ParameterType::floating:
      return gpu::spec_constant(id, static_cast<float>(value));
    case ParameterType::integer:
    case ParameterType::choice:
      break;
  }
  return gpu::spec_constant(id, static_cast<std::int32_t>(value));
}

}  // namespace

std::string parameter_declarations(const StageInfo& stage) {
  if (stage.parameters.size() > kParametersPerStage) {
    throw input_error("{}: stage {} has {} parameters; accepted: up to {}", stage.origin.string(), stage.id(),
                      stage.parameters.size(), kParametersPerStage);
  }
  std::string text;
  std::uint32_t id = first_constant_id(stage.family);
  for (const StageParameter& parameter : stage.parameters) {
    const std::string name = stage.family + "_" + parameter.name;
    const std::string head = fmt::format("layout(constant_id = {}) const ", id++);
    if (parameter.type == ParameterType::boolean) {
      text += fmt::format("{}bool {} = {};\n", head, name, parameter.default_value != 0.0);
    } else if (parameter.type == ParameterType::floating) {
      text += fmt::format("{}float {} = {:.9e};\n", head, name, parameter.default_value);
    } else {
      text += fmt::format("{}int {} = {:.0f};\n", head, name, parameter.default_value);
    }
  }
  return text;
}

std::vector<gpu::SpecConstant> parameter_constants(const PipelineStage& stage) {
  std::vector<gpu::SpecConstant> constants;
  std::uint32_t id = first_constant_id(stage.stage.family);
  for (std::size_t i = 0; i < stage.values.size(); ++i) {
    constants.push_back(constant(id++, stage.stage.parameters[i], stage.values[i]));
  }
  return constants;
}

std::string parameter_macros(const PipelineStage& stage) {
  const auto macro_name = [&](const std::string& name) {
    std::string text = "BRACE_" + stage.stage.family + "_" + name;
    for (char& c : text)
      c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
  };
  std::string text;
  for (std::size_t i = 0; i < stage.values.size(); ++i) {
    const StageParameter& parameter = stage.stage.parameters[i];
    if (parameter.type == ParameterType::choice) {
      const std::string& chosen = parameter.choices[static_cast<std::size_t>(stage.values[i])];
      text += "#define " + macro_name(parameter.name + "_" + chosen) + "\n";
    } else if (parameter.minimum == 0.0 && parameter.default_value == 0.0 && stage.values[i] > 0.0) {
      text += "#define " + macro_name(parameter.name + "_ON") + "\n";
    }
  }
  return text;
}

StageGlsl stage_glsl(std::span<const PipelineStage* const> stages) {
  StageGlsl glsl;
  std::map<std::string, gpu::GlslSource, std::less<>> files;
  std::vector<std::filesystem::path> folders;
  for (const std::string& family : stage_families()) {
    const std::string name = "stage/" + family + ".glsl";
    files[name] = {name, ""};
  }
  std::string parameters;
  for (const PipelineStage* chosen : stages) {
    const StageInfo& stage = chosen->stage;
    parameters += parameter_declarations(stage) + parameter_macros(*chosen);
    const auto constants = parameter_constants(*chosen);
    glsl.constants.insert(glsl.constants.end(), constants.begin(), constants.end());
    // A native skip stage keeps a map of distances: the public hook reads it.
    if (stage.native != nullptr && stage.family == "skip")
      files["stage/skip.glsl"] = {"stage/skip.glsl", "#include \"brace/skip_distance.glsl\"\n"};
    if (stage.glsl_source.empty()) continue;
    files["stage/" + stage.family + ".glsl"] = gpu::read_glsl(stage.glsl_source, stage.glsl_source.string());
    folders.push_back(stage.glsl_source.parent_path());
  }
  files["stage/parameters.glsl"] = {"parameters of the stages", parameters};
  const gpu::IncludeResolver beside = gpu::directory_resolver(std::move(folders));
  glsl.resolve = [files = std::move(files), beside](std::string_view name) -> std::optional<gpu::GlslSource> {
    const auto found = files.find(name);
    return found == files.end() ? beside(name) : found->second;
  };
  return glsl;
}

}  // namespace brace
