#include "runtime/host/plugin_library.hpp"

#include <dlfcn.h>

#include "base/error.hpp"
#include "runtime/host/descriptor_check.hpp"

namespace brace {

const char* result_name(brace_result result) {
  switch (result) {
    case BRACE_OK:
      return "BRACE_OK";
    case BRACE_ERROR:
      return "BRACE_ERROR";
    case BRACE_UNSUPPORTED:
      return "BRACE_UNSUPPORTED";
    case BRACE_INVALID_ARGUMENT:
      return "BRACE_INVALID_ARGUMENT";
  }
  return "a result that is none";
}

namespace {

std::string version_text(std::uint32_t version) {
  return fmt::format("{}.{}", version >> 16, version & 0xffffu);
}

std::string range_text(std::uint32_t oldest, std::uint32_t newest) {
  return oldest == newest ? version_text(oldest)
                          : fmt::format("{} to {}", version_text(oldest), version_text(newest));
}

std::string text_of(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

extern "C" void log_from_plugin(void* context, brace_log_level level, const char* message) {
  const auto& log = *static_cast<const PluginLog*>(context);
  try {
    if (log && message != nullptr) log(level, message);
  } catch (...) {  // nothing throws across the interface; a line of log is not worth a run
  }
}

}  // namespace

std::shared_ptr<const PluginLibrary> PluginLibrary::load(const std::filesystem::path& file, PluginLog log) {
  std::shared_ptr<PluginLibrary> library(new PluginLibrary(file, std::move(log)));
  library->call_entry();
  return library;
}

PluginLibrary::PluginLibrary(std::filesystem::path file, PluginLog log)
    : file_(std::move(file)), log_(std::move(log)) {
  check_shared_library(file_);
  // An absolute path: dlopen would look up a bare name in the system's folders.
  handle_ = dlopen(std::filesystem::absolute(file_).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ == nullptr) {
    throw device_error(
        "{}: cannot be loaded as a plug-in; expected a library whose symbols all resolve; found: {}",
        file_.string(), text_of(dlerror()));
  }
}

PluginLibrary::~PluginLibrary() {
  if (handle_ != nullptr) dlclose(handle_);
}

void PluginLibrary::call_entry() {
  void* symbol = dlsym(handle_, BRACE_LIBRARY_ENTRY_NAME);
  if (symbol == nullptr) {
    throw device_error("{}: is not a Brace plug-in; expected the symbol {}; found none of this name",
                       file_.string(), BRACE_LIBRARY_ENTRY_NAME);
  }
  const auto entry = reinterpret_cast<brace_library_entry_function>(symbol);
  host_.struct_size = sizeof host_;
  host_.abi_version_min = BRACE_ABI_VERSION_MAKE(BRACE_ABI_VERSION_MAJOR, 0);
  host_.abi_version_max = BRACE_ABI_VERSION;
  host_.name = "brace";
  host_.version = BRACE_VERSION;
  host_.context = &log_;
  host_.log = log_from_plugin;
  brace_library library{};
  library.struct_size = sizeof library;
  brace_result result = BRACE_ERROR;
  try {
    result = entry(&host_, &library);
  } catch (...) {
    throw device_error("{}: {} failed; expected BRACE_OK; found an exception thrown across the C interface",
                       file_.string(), BRACE_LIBRARY_ENTRY_NAME);
  }

  const bool overlaps = brace_negotiate_abi(host_.abi_version_min, host_.abi_version_max,
                                            library.abi_version_min, library.abi_version_max) != 0;
  if (!overlaps) {
    throw device_error("{}: plug-in {} is for another version of the stage interface; expected {}; found {}",
                       file_.string(), text_of(library.name),
                       range_text(host_.abi_version_min, host_.abi_version_max),
                       range_text(library.abi_version_min, library.abi_version_max));
  }
  if (result != BRACE_OK) {
    throw device_error("{}: {} failed; expected BRACE_OK; found {}", file_.string(), BRACE_LIBRARY_ENTRY_NAME,
                       result_name(result));
  }
  if (library.abi_version < host_.abi_version_min || library.abi_version > host_.abi_version_max) {
    throw device_error("{}: {} chose a version that was not offered; expected {}; found {}", file_.string(),
                       BRACE_LIBRARY_ENTRY_NAME, range_text(host_.abi_version_min, host_.abi_version_max),
                       version_text(library.abi_version));
  }
  if (library.stage_count == 0 || library.stages == nullptr) {
    throw device_error("{}: plug-in {} has no stages; expected at least one; found none", file_.string(),
                       text_of(library.name));
  }
  name_ = text_of(library.name);
  version_ = text_of(library.version);
  abi_version_ = library.abi_version;
  stages_.reserve(library.stage_count);
  for (std::uint32_t i = 0; i < library.stage_count; ++i)
    take_stage(library.stages[i], i);
}

void PluginLibrary::take_stage(const brace_stage_descriptor* descriptor, std::uint32_t index) {
  const std::string first = fmt::format("{}: stage {}", file_.string(), index);
  brace_stage_descriptor own = own_descriptor(descriptor, first);
  const std::string place = fmt::format("{} '{}'", first, own.name == nullptr ? "" : own.name);
  params_.push_back(own_params(own, place));
  own.params = params_.back().data();
  functions_.push_back(own_functions(own, place));
  own.functions = functions_.back().data();
  check_descriptor(own, place);
  stages_.push_back(own);
}

}  // namespace brace
