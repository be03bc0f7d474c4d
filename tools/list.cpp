#include <functional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "hmd_sim/device_profile.hpp"
#include "runtime/volume/generators.hpp"
#include "runtime/volume/transfer_function.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

using Json = nlohmann::ordered_json;

Json list_devices() {
  Json out = Json::array();
  for (const sim::DeviceProfile& profile : sim::list_device_profiles(data_folder() / "devices")) {
    out.push_back({{"name", profile.name},
                   {"title", profile.display_name},
                   {"panel_px", {profile.panel_width_px, profile.panel_height_px}},
                   {"refresh_hz", profile.refresh.hz()},
                   {"lens", std::string(sim::to_string(profile.lens_kind))},
                   {"scan_out", std::string(sim::to_string(profile.scan_out.direction))},
                   {"assumed", profile.assumed.size()}});
  }
  return out;
}

Json parameter_json(const StageParameter& parameter) {
  static const char* const types[] = {"bool", "int", "float", "choice"};
  Json json = {
      {"name", parameter.name}, {"type", types[static_cast<int>(parameter.type)]}, {"unit", parameter.unit}};
  if (parameter.type == ParameterType::choice) {
    json["choices"] = parameter.choices;
    json["default"] = parameter.choices[static_cast<std::size_t>(parameter.default_value)];
  } else if (parameter.type == ParameterType::boolean) {
    json["default"] = parameter.default_value != 0.0;
  } else {
    json["min"] = parameter.minimum;
    json["max"] = parameter.maximum;
    json["default"] = parameter.default_value;
  }
  json["help"] = parameter.help;
  return json;
}

Json list_stages(const std::vector<std::string>& plugin_path) {
  Json out = Json::array();
  const auto [registry, plugins] = make_stages(plugin_path);
  warn_of_broken(plugins);
  for (const std::string& family : stage_families()) {
    for (const StageInfo& stage : registry.stages()) {
      if (stage.family != family) continue;
      Json parameters = Json::array();
      for (const StageParameter& parameter : stage.parameters)
        parameters.push_back(parameter_json(parameter));
      out.push_back(
          {{"name", stage.id()},
           {"version", stage.version},
           {"form", stage.native != nullptr ? "native" : (stage.glsl_source.empty() ? "host" : "glsl")},
           {"help", stage.help},
           {"parameters", parameters}});
    }
  }
  return out;
}

/// What the search path holds; a file that cannot be loaded is a row with its error.
Json list_plugins(const std::vector<std::string>& plugin_path) {
  Json out = Json::array();
  for (const PluginFile& plugin : make_stages(plugin_path).plugins) {
    Json row = {{"name", plugin.file.string()},
                {"form", plugin.file.extension() == ".so" ? "native" : "glsl"},
                {"version", plugin.version},
                {"stages", join(plugin.stages)}};
    if (!plugin.error.empty()) row["error"] = plugin.error;
    out.push_back(std::move(row));
  }
  return out;
}

Json list_generators() {
  Json out = Json::array();
  for (const GeneratorInfo& generator : generators()) {
    out.push_back({{"name", generator.name},
                   {"help", generator.help},
                   {"use", "generator:" + generator.name + ":128"}});
  }
  return out;
}

Json list_files(const std::filesystem::path& folder, const char* extension = ".toml") {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == extension) names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  Json out = Json::array();
  for (const std::string& name : names)
    out.push_back({{"name", name}});
  return out;
}

Json list_costs() {
  Json out = list_files(data_folder() / "costs");
  for (Json& model : out)
    model["name"] = "model:" + model["name"].get<std::string>();
  out.push_back({{"name", "measured"}, {"help", "time stamps of the device at hand: not deterministic"}});
  out.push_back({{"name", "recorded:DIR"}, {"help", "the costs of an earlier run"}});
  out.push_back({{"name", "scripted"}, {"help", "[[clock.script]] segments"}});
  return out;
}

Json list_keys() {
  Json out = Json::array();
  for (const SessionKey& key : session_keys()) {
    out.push_back({{"name", key.name},
                   {"type", key.type},
                   {"default", key.fallback},
                   {"accepted", key.accepted},
                   {"help", key.help}});
  }
  return out;
}

std::string cell(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_array() && value.size() == 2) return fmt::format("{} x {}", value[0].dump(), value[1].dump());
  return value.dump();
}

std::string parameter_line(const Json& p) {
  std::string range = p.contains("choices") ? fmt::format("one of {}", p["choices"].dump())
                      : p.contains("min")   ? fmt::format("{} to {}", p["min"].dump(), p["max"].dump())
                                            : std::string("true or false");
  const std::string unit = p["unit"].get<std::string>();
  return fmt::format("      {} = {}{}  ({}): {}", cell(p["name"]), p["default"].dump(),
                     unit.empty() ? "" : " " + unit, range, cell(p["help"]));
}

void print_table(const Json& rows) {
  if (rows.empty()) fmt::print("none found\n");
  for (const Json& row : rows) {
    std::string line;
    for (const auto& [key, value] : row.items()) {
      if (key == "parameters") continue;
      const std::string text = cell(value);
      line += key == "name" ? fmt::format("{:<26}", text) : fmt::format("  {}", text.empty() ? "-" : text);
    }
    fmt::print("{}\n", line);
    if (!row.contains("parameters")) continue;
    for (const Json& parameter : row["parameters"])
      fmt::print("{}\n", parameter_line(parameter));
  }
}

}  // namespace

int list_command(const ListCommand& command) {
  const std::vector<std::pair<std::string, std::function<Json()>>> lists = {
      {"devices", list_devices},
      {"stages", [&] { return list_stages(command.plugin_path); }},
      {"plugins", [&] { return list_plugins(command.plugin_path); }},
      {"generators", list_generators},
      {"costs", list_costs},
      {"transfer-functions", [] { return list_files(data_folder() / "transfer_functions"); }},
      {"traces", [] { return list_files(data_folder() / "traces", ".trace"); }},
      {"keys", list_keys}};
  std::vector<std::string> names;
  for (const auto& [name, make] : lists) {
    names.push_back(name);
    if (name != command.what) continue;
    const Json rows = make();
    if (command.json) {
      fmt::print("{}\n", rows.dump(2));
    } else {
      print_table(rows);
    }
    return static_cast<int>(ExitCode::done);
  }
  throw input_error("list: there is no list '{}'{}; accepted: {}", command.what,
                    did_you_mean(command.what, names), join(names));
}

}  // namespace brace
