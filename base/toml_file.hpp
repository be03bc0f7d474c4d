#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <toml++/toml.h>

namespace brace {

// Reading TOML with Brace's error messages. Include from .cpp files only: toml++ is a heavy header.

/// Throws input_error naming file, line and what the parser expected.
toml::table read_toml_file(const std::filesystem::path& path);
toml::table parse_toml(std::string_view text, const std::string& name);

/// "file:12" of a node (or "file" where a node has no place).
std::string place_of(const toml::node& node, const std::string& file);

/// Throws input_error for the first key of `table` that is not in `known`, naming the nearest known one.
/// `where` is the table's dotted name, "" for the top.
void reject_unknown_keys(const toml::table& table, const std::string& file, const std::string& where,
                         const std::vector<std::string>& known);

}  // namespace brace
