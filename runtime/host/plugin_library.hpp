#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plugins/abi/brace_stage.h"

namespace brace {

class StageRegistry;

/// The name of a result in the C header.
const char* result_name(brace_result result);

/// A line that a plug-in wants the user to see. May be called from any thread.
using PluginLog = std::function<void(brace_log_level level, const std::string& message)>;

/// A shared library of native stages, loaded and checked. Whoever holds a pointer to it keeps the code
/// mapped: StageInfo does, so that a library outlives its stages.
class PluginLibrary {
 public:
  /// Loads `file` (dlopen, RTLD_NOW | RTLD_LOCAL) and checks everything that a host can check before it makes
  /// a stage: the ELF header, the entry symbol, the ABI version, the descriptors. Throws device_error that
  /// names the file, what was expected and what was found; input_error if the file cannot be read.
  static std::shared_ptr<const PluginLibrary> load(const std::filesystem::path& file, PluginLog log = {});

  ~PluginLibrary();
  PluginLibrary(const PluginLibrary&) = delete;
  PluginLibrary& operator=(const PluginLibrary&) = delete;

  const std::filesystem::path& file() const { return file_; }
  const std::string& name() const { return name_; }
  const std::string& version() const { return version_; }
  std::uint32_t abi_version() const { return abi_version_; }

  /// The stages as this host's structs: copies in full size, so that fields which an older library does not
  /// know are null. Valid as long as the library.
  std::span<const brace_stage_descriptor> stages() const { return stages_; }

 private:
  PluginLibrary(std::filesystem::path file, PluginLog log);
  void call_entry();
  void take_stage(const brace_stage_descriptor* descriptor, std::uint32_t index);

  std::filesystem::path file_;
  PluginLog log_;
  brace_host host_{};
  void* handle_ = nullptr;
  std::string name_, version_;
  std::uint32_t abi_version_ = 0;
  std::vector<brace_stage_descriptor> stages_;
  std::deque<std::vector<brace_param>> params_;
  std::deque<std::vector<std::byte>> functions_;
};

/// Throws device_error unless `file` is a whole ELF shared library for this machine; says what it is instead.
void check_shared_library(const std::filesystem::path& file);

/// Where plug-ins are looked for, in this order.
struct PluginSearch {
  std::vector<std::filesystem::path> given;    // --plugin-path: folders, libraries or manifests
  std::vector<std::filesystem::path> ambient;  // BRACE_PLUGIN_PATH
  std::filesystem::path installed;             // PREFIX/lib/brace/plugins; may be missing
};

/// What a search found in one file.
struct PluginFile {
  std::filesystem::path file;
  std::string library, version;     // of a shared library; empty for a manifest
  std::vector<std::string> stages;  // "cast/mip": those that are now in the registry
  std::string error;                // why others, or all, are not; "" if nothing is missing
};

/// Splits BRACE_PLUGIN_PATH at ':'; empty parts are left out.
std::vector<std::filesystem::path> split_plugin_path(std::string_view value);

/// Adds what the search finds, in sorted order per folder: NAME.so, stage.toml, NAME/stage.toml and
/// FAMILY/NAME/stage.toml. A file reached twice is loaded once. Throws device_error that names both files for
/// a stage whose name is taken, input_error for a place that is not there or a broken manifest.
void add_plugins(StageRegistry& registry, const PluginSearch& search, const PluginLog& log = {});

/// The same, but a file that cannot be loaded, or a stage whose name is taken, is left out: the registry
/// remembers why and says so to whoever asks for it. Throws input_error for a place of `given` that is not
/// there. Returns the files in the order of the search.
std::vector<PluginFile> add_working_plugins(StageRegistry& registry, const PluginSearch& search,
                                            const PluginLog& log = {});

}  // namespace brace
