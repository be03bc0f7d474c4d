#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "base/toml_file.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

namespace {

const std::vector<std::string> kTypes = {"bool", "int", "float", "choice"};

bool is_identifier(const std::string& name) {
  if (name.empty() || name[0] < 'a' || name[0] > 'z') return false;
  return name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

std::string required_text(const toml::table& table, const char* key, const std::string& file) {
  const toml::node* node = table.get(key);
  if (node == nullptr) throw input_error("{}: key 'stage.{}' is missing", place_of(table, file), key);
  const auto text = node->value_exact<std::string>();
  if (!text || text->empty()) throw input_error("{}: 'stage.{}' wants a text", place_of(*node, file), key);
  return *text;
}

double number(const toml::table& table, const char* key, const std::string& file,
              std::optional<double> fallback) {
  const toml::node* node = table.get(key);
  if (node == nullptr && fallback) return *fallback;
  if (node == nullptr) throw input_error("{}: a parameter wants the key '{}'", place_of(table, file), key);
  if (const auto flag = node->value_exact<bool>()) return *flag ? 1.0 : 0.0;
  const auto value = node->value<double>();
  if (!value || !std::isfinite(*value)) {
    throw input_error("{}: '{}' wants a finite number", place_of(*node, file), key);
  }
  return *value;
}

void read_choices(const toml::table& table, const std::string& file, StageParameter& parameter) {
  const toml::array* choices = table["choices"].as_array();
  if (choices != nullptr) {
    for (const auto& choice : *choices)
      parameter.choices.push_back(choice.value_or(std::string()));
  }
  if (parameter.choices.empty()) {
    throw input_error("{}: a choice parameter wants choices = [\"…\", …]", place_of(table, file));
  }
  parameter.maximum = static_cast<double>(parameter.choices.size()) - 1.0;
  const std::string chosen = table["default"].value_or(parameter.choices.front());
  for (std::size_t i = 0; i < parameter.choices.size(); ++i) {
    if (parameter.choices[i] == chosen) {
      parameter.default_value = static_cast<double>(i);
      return;
    }
  }
  throw input_error("{}: default '{}' is not among the choices: {}", place_of(table, file), chosen,
                    join(parameter.choices));
}

StageParameter read_parameter(const toml::table& table, const std::string& file) {
  reject_unknown_keys(table, file, "parameter",
                      {"name", "type", "unit", "min", "max", "default", "help", "choices"});
  StageParameter parameter;
  parameter.name = table["name"].value_or(std::string());
  if (!is_identifier(parameter.name)) {
    throw input_error("{}: parameter name '{}' is not snake_case (a-z, 0-9, _)", place_of(table, file),
                      parameter.name);
  }
  parameter.unit = table["unit"].value_or(std::string());
  parameter.help = table["help"].value_or(std::string());
  const std::string type = table["type"].value_or(std::string());
  if (type == "choice") {
    parameter.type = ParameterType::choice;
    read_choices(table, file, parameter);
    return parameter;
  }
  if (type == "bool") {
    parameter.type = ParameterType::boolean;
    parameter.maximum = 1.0;
    parameter.default_value = number(table, "default", file, std::nullopt);
    return parameter;
  }
  if (type != "int" && type != "float") {
    throw input_error("{}: parameter '{}' has type '{}'{}; accepted: {}", place_of(table, file),
                      parameter.name, type, did_you_mean(type, kTypes), join(kTypes));
  }
  parameter.type = type == "int" ? ParameterType::integer : ParameterType::floating;
  parameter.minimum = number(table, "min", file, std::nullopt);
  parameter.maximum = number(table, "max", file, std::nullopt);
  parameter.default_value = number(table, "default", file, std::nullopt);
  return parameter;
}

std::vector<std::string> texts(const toml::table& table, const char* key, const std::string& file) {
  std::vector<std::string> list;
  const toml::node* node = table.get(key);
  if (node == nullptr) return list;
  if (!node->is_array()) throw input_error("{}: '{}' wants a list of texts", place_of(*node, file), key);
  for (const auto& entry : *node->as_array()) {
    const auto text = entry.value_exact<std::string>();
    if (!text) throw input_error("{}: '{}' wants a list of texts", place_of(entry, file), key);
    list.push_back(*text);
  }
  return list;
}

}  // namespace

StageInfo read_stage_manifest(const std::filesystem::path& path) {
  const std::string file = path.string();
  const toml::table manifest = read_toml_file(path);
  reject_unknown_keys(manifest, file, "", {"stage", "parameter"});
  const toml::table* head = manifest["stage"].as_table();
  if (head == nullptr) throw input_error("{}: a stage manifest starts with [stage]", file);
  reject_unknown_keys(*head, file, "stage",
                      {"kind", "name", "version", "help", "source", "inputs", "outputs"});

  StageInfo info;
  info.origin = path;
  info.family = required_text(*head, "kind", file);
  const auto& families = stage_families();
  if (std::find(families.begin(), families.end(), info.family) == families.end()) {
    throw input_error("{}: kind '{}' is unknown{}; accepted: {}", place_of(*head->get("kind"), file),
                      info.family, did_you_mean(info.family, families), join(families));
  }
  info.name = required_text(*head, "name", file);
  if (!is_identifier(info.name)) {
    throw input_error("{}: name '{}' is not snake_case (a-z, 0-9, _)", place_of(*head->get("name"), file),
                      info.name);
  }
  info.version = required_text(*head, "version", file);
  info.help = required_text(*head, "help", file);
  info.inputs = texts(*head, "inputs", file);
  info.outputs = texts(*head, "outputs", file);
  if (const auto source = (*head)["source"].value<std::string>()) {
    info.glsl_source = path.parent_path() / *source;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(info.glsl_source, ignored)) {
      throw input_error("{}: source '{}' is not there", place_of(*head->get("source"), file),
                        info.glsl_source.string());
    }
  }
  const toml::node* parameters = manifest.get("parameter");
  if (parameters == nullptr) return info;
  if (!parameters->is_array_of_tables()) {
    throw input_error("{}: parameters are written as [[parameter]] tables", place_of(*parameters, file));
  }
  for (const auto& entry : *parameters->as_array()) {
    StageParameter parameter = read_parameter(*entry.as_table(), file);
    check_parameter_value(info, parameter, parameter.default_value, place_of(entry, file) + " (default)");
    for (const StageParameter& other : info.parameters) {
      if (other.name == parameter.name) {
        throw input_error("{}: parameter '{}' is there twice", place_of(entry, file), parameter.name);
      }
    }
    info.parameters.push_back(std::move(parameter));
  }
  return info;
}

}  // namespace brace
