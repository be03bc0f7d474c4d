#include <algorithm>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "base/toml_file.hpp"
#include "runtime/volume/transfer_function.hpp"

namespace brace {
namespace {

double required_number(const toml::table& table, const char* key, const std::string& place) {
  const auto value = table[key].value<double>();
  if (!value) throw input_error("{}: '{}' is missing or not a number", place, key);
  return *value;
}

std::string optional_word(const toml::table& table, const char* key, const std::string& file,
                          const std::string& otherwise, const std::vector<std::string>& accepted) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return otherwise;
  const auto word = node->value_exact<std::string>();
  if (!word || std::ranges::find(accepted, *word) == accepted.end())
    throw input_error("{}: {}: accepted: {}", place_of(*node, file), key, join(accepted));
  return *word;
}

/// `opacity` per reference length, or `absorption` in the file's unit: one of the two.
double parse_kappa(const toml::table& table, double reference_length, const std::string& place) {
  const bool has_opacity = table.contains("opacity");
  if (has_opacity == table.contains("absorption"))
    throw input_error("{}: accepted: either 'opacity' or 'absorption'", place);
  if (!has_opacity) return required_number(table, "absorption", place);
  const double opacity = required_number(table, "opacity", place);
  try {
    return kappa_from_opacity(opacity, reference_length);
  } catch (const Error& error) {
    throw input_error("{}: {}", place, error.what());
  }
}

TransferPoint parse_point(const toml::node& node, double reference_length, bool per_metre,
                          const std::string& file) {
  const std::string place = place_of(node, file);
  const toml::table* table = node.as_table();
  if (table == nullptr)
    throw input_error("{}: accepted: a point such as {{ value = 0, r = 1, g = 1, b = 1, opacity = 0.5 }}",
                      place);
  reject_unknown_keys(*table, file, "points", {"value", "r", "g", "b", "opacity", "absorption"});
  if (per_metre && table->contains("opacity"))
    throw input_error("{}: 'opacity' is per voxel; with absorption_unit = \"per_metre\" give 'absorption'",
                      place);
  TransferPoint point;
  point.value = required_number(*table, "value", place);
  point.sample.r = required_number(*table, "r", place);
  point.sample.g = required_number(*table, "g", place);
  point.sample.b = required_number(*table, "b", place);
  point.sample.kappa = parse_kappa(*table, reference_length, place);
  return point;
}

std::optional<Window> parse_window(const toml::table& table, ValueDomain domain, const std::string& file) {
  if (!table.contains("window") && !table.contains("level")) return std::nullopt;
  if (domain != ValueDomain::fraction)
    throw input_error("{}: 'window' and 'level' need domain = \"fraction\"", file);
  return Window{required_number(table, "level", file), required_number(table, "window", file)};
}

TransferFunction from_table(const toml::table& table, const std::string& source) {
  reject_unknown_keys(
      table, source, "",
      {"name", "description", "domain", "window", "level", "reference_length", "absorption_unit", "points"});
  TransferFunction tf;
  tf.source = source;
  tf.name = table["name"].value_or(std::filesystem::path(source).stem().string());
  if (optional_word(table, "domain", source, "data", {"data", "fraction"}) == "fraction")
    tf.domain = ValueDomain::fraction;
  const bool per_metre =
      optional_word(table, "absorption_unit", source, "per_voxel", {"per_voxel", "per_metre"}) == "per_metre";
  if (per_metre) tf.unit = AbsorptionUnit::per_metre;
  tf.window = parse_window(table, tf.domain, source);
  const double reference_length =
      table.contains("reference_length") ? required_number(table, "reference_length", source) : 1.0;
  const toml::array* points = table["points"].as_array();
  if (points == nullptr) throw input_error("{}: 'points' is missing or not an array", source);
  for (const toml::node& node : *points)
    tf.points.push_back(parse_point(node, reference_length, per_metre, source));
  validate(tf);
  return tf;
}

}  // namespace

TransferFunction parse_transfer_function(std::string_view toml_text, const std::string& source) {
  return from_table(parse_toml(toml_text, source), source);
}

std::vector<std::string> list_transfer_functions(const std::filesystem::path& preset_folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(preset_folder, error))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  if (error) throw input_error("{}: {}", preset_folder.string(), error.message());
  std::ranges::sort(names);
  return names;
}

TransferFunction load_transfer_function(const std::string& path_or_preset,
                                        const std::filesystem::path& preset_folder) {
  const bool is_path = path_or_preset.ends_with(".toml") || path_or_preset.find('/') != std::string::npos;
  std::filesystem::path path = path_or_preset;
  if (!is_path) {
    const auto names = list_transfer_functions(preset_folder);
    if (std::ranges::find(names, path_or_preset) == names.end())
      throw input_error("transfer function '{}': no such preset{} (accepted: a .toml file or one of {})",
                        path_or_preset, did_you_mean(path_or_preset, names), join(names));
    path = preset_folder / (path_or_preset + ".toml");
  }
  return from_table(read_toml_file(path), path.string());
}

}  // namespace brace
