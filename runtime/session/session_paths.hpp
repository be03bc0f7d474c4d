#pragma once

#include <filesystem>
#include <string>

namespace brace {

/// Relative paths in a session are relative to the session file's folder.
inline std::filesystem::path absolute_from(const std::filesystem::path& folder, const std::string& path) {
  const std::filesystem::path given(path);
  return (given.is_absolute() ? given : folder / given).lexically_normal();
}

/// A name of something shipped (trace, preset) and no path.
inline bool is_bare_name(const std::string& text) {
  return text.find_first_of("/.") == std::string::npos;
}

}  // namespace brace
