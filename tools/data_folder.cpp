#include <cstdlib>

#include "base/error.hpp"
#include "tools/command.hpp"

namespace brace {

std::filesystem::path data_folder() {
  std::error_code ignored;
  if (const char* given = std::getenv("BRACE_DATA_DIR"); given != nullptr && *given != '\0') {
    if (std::filesystem::is_directory(given, ignored)) return given;
    throw input_error("BRACE_DATA_DIR={}: is not a folder", given);
  }
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::filesystem::path folder = program.parent_path().parent_path() / "share" / "brace";
  if (std::filesystem::is_directory(folder, ignored)) return folder;
  throw device_error("{}: Brace's data folder is not there; install Brace again or set BRACE_DATA_DIR",
                     folder.string());
}

}  // namespace brace
