#pragma once

#include <filesystem>
#include <string>

namespace brace {

/// The bytes of a file. Throws brace::Error (exit code 2) naming it when it cannot be read.
std::string read_text_file(const std::filesystem::path& path);

}  // namespace brace
