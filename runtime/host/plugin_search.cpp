#include <algorithm>
#include <set>

#include "base/error.hpp"
#include "runtime/host/plugin_library.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

bool is_plugin_file(const fs::path& path) {
  return is_file(path) && (path.extension() == ".so" || path.filename() == "stage.toml");
}

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    found.push_back(entry->path());
  }
  if (failed)
    throw input_error("{}: the plug-in folder cannot be read: {}", folder.string(), failed.message());
  std::sort(found.begin(), found.end());
  return found;
}

/// Libraries and manifests of a folder, down to FAMILY/NAME/stage.toml.
void find_files(const fs::path& folder, int depth, std::vector<fs::path>& files) {
  for (const fs::path& entry : entries(folder)) {
    const bool counts =
        depth == 0 ? is_plugin_file(entry) : is_file(entry) && entry.filename() == "stage.toml";
    if (counts) files.push_back(entry);
    if (depth < 2 && is_folder(entry)) find_files(entry, depth + 1, files);
  }
}

std::vector<fs::path> files_of(const fs::path& place) {
  if (is_plugin_file(place)) return {place};
  if (!is_folder(place)) {
    throw input_error("plug-in path '{}': accepted: a folder, a shared library (.so) or a stage.toml",
                      place.string());
  }
  std::vector<fs::path> files;
  find_files(place, 0, files);
  return files;
}

void add_stage(StageRegistry& registry, StageInfo stage) {
  for (const StageInfo& other : registry.stages()) {
    if (other.family != stage.family || other.name != stage.name) continue;
    throw device_error("{}: stage {} is there already; expected a name of its own; found it in {}",
                       stage.origin.string(), stage.id(),
                       other.origin.empty() ? std::string("the host itself") : other.origin.string());
  }
  registry.add(std::move(stage));
}

void add_file(StageRegistry& registry, const fs::path& file, const PluginLog& log) {
  if (file.extension() != ".so") {
    add_stage(registry, read_stage_manifest(file));
    return;
  }
  const std::shared_ptr<const PluginLibrary> library = PluginLibrary::load(file, log);
  for (const brace_stage_descriptor& descriptor : library->stages()) {
    StageInfo stage = stage_info(descriptor, file);
    stage.library = library;
    add_stage(registry, std::move(stage));
  }
}

/// The stages of a file, and what it says of itself.
std::vector<StageInfo> read_stages(PluginFile& plugin, const PluginLog& log) {
  if (plugin.file.extension() != ".so") return {read_stage_manifest(plugin.file)};
  const std::shared_ptr<const PluginLibrary> library = PluginLibrary::load(plugin.file, log);
  plugin.library = library->name();
  plugin.version = library->version();
  std::vector<StageInfo> stages;
  for (const brace_stage_descriptor& descriptor : library->stages()) {
    stages.push_back(stage_info(descriptor, plugin.file));
    stages.back().library = library;
  }
  return stages;
}

PluginFile add_what_works(StageRegistry& registry, const fs::path& file, const PluginLog& log) {
  PluginFile plugin{file, "", "", {}, ""};
  std::vector<StageInfo> stages;
  try {
    stages = read_stages(plugin, log);
  } catch (const Error& error) {
    plugin.error = error.what();
    registry.add_missing("", plugin.error);
    return plugin;
  }
  for (StageInfo& stage : stages) {
    const std::string id = stage.id();
    try {
      add_stage(registry, std::move(stage));
      plugin.stages.push_back(id);
    } catch (const Error& error) {
      plugin.error += (plugin.error.empty() ? "" : "; ") + std::string(error.what());
      registry.add_missing(id, error.what());
    }
  }
  return plugin;
}

}  // namespace

std::vector<fs::path> split_plugin_path(std::string_view value) {
  std::vector<fs::path> parts;
  while (!value.empty()) {
    const std::size_t colon = value.find(':');
    if (colon != 0) parts.emplace_back(value.substr(0, colon));
    value = colon == std::string_view::npos ? std::string_view() : value.substr(colon + 1);
  }
  return parts;
}

void add_plugins(StageRegistry& registry, const PluginSearch& search, const PluginLog& log) {
  std::vector<fs::path> places = search.given;
  places.insert(places.end(), search.ambient.begin(), search.ambient.end());
  if (is_folder(search.installed)) places.push_back(search.installed);
  std::set<fs::path> seen;
  for (const fs::path& place : places) {
    for (const fs::path& file : files_of(place)) {
      std::error_code ignored;
      if (seen.insert(fs::canonical(file, ignored)).second) add_file(registry, file, log);
    }
  }
}

std::vector<PluginFile> add_working_plugins(StageRegistry& registry, const PluginSearch& search,
                                            const PluginLog& log) {
  std::vector<PluginFile> found;
  std::set<fs::path> seen;
  const auto add_place = [&](const fs::path& place) {
    for (const fs::path& file : files_of(place)) {
      std::error_code ignored;
      if (seen.insert(fs::canonical(file, ignored)).second)
        found.push_back(add_what_works(registry, file, log));
    }
  };
  for (const fs::path& place : search.given)
    add_place(place);
  std::vector<fs::path> standing = search.ambient;
  if (is_folder(search.installed)) standing.push_back(search.installed);
  for (const fs::path& place : standing) {
    try {
      add_place(place);
    } catch (const Error& error) {  // a place that went away must not end every run
      found.push_back({place, "", "", {}, error.what()});
      registry.add_missing("", error.what());
    }
  }
  return found;
}

}  // namespace brace
