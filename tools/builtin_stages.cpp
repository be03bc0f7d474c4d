#include <cstdlib>

#include <fmt/core.h>

#include "stages/control/control.hpp"
#include "stages/predict/predict.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

PluginSearch plugin_search(const std::vector<std::string>& given) {
  PluginSearch search;
  search.given.assign(given.begin(), given.end());
  if (const char* ambient = std::getenv("BRACE_PLUGIN_PATH"); ambient != nullptr)
    search.ambient = split_plugin_path(ambient);
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  search.installed = program.parent_path().parent_path() / BRACE_LIBRARY_FOLDER / "brace" / "plugins";
  return search;
}

void print_log(brace_log_level level, const std::string& message) {
  const char* const names[] = {"info", "warning", "error"};
  const auto index = static_cast<std::size_t>(level);
  fmt::print(stderr, "brace: plug-in: {}: {}\n", index < std::size(names) ? names[index] : "message",
             message);
}

}  // namespace

Stages make_stages(const std::vector<std::string>& plugin_path) {
  Stages stages;
  StageRegistry& registry = stages.registry;
  registry.add_folder(data_folder() / "stages");
  registry.add(stages::predict_none, {});
  registry.add(stages::predict_constant_rate, {});
  registry.add(stages::predict_constant_acceleration, {});
  registry.add(stages::predict_kalman, {});
  registry.add(stages::control_fixed, {});
  registry.add(stages::control_mab_dynamic, {});
  registry.add(stages::control_pi, {});
  registry.add(stages::control_quantile, {});
  stages.plugins = add_working_plugins(registry, plugin_search(plugin_path), print_log);
  return stages;
}

void warn_of_broken(const std::vector<PluginFile>& plugins) {
  for (const PluginFile& plugin : plugins) {
    if (!plugin.error.empty()) fmt::print(stderr, "brace: warning: plug-in left out: {}\n", plugin.error);
  }
}

}  // namespace brace
