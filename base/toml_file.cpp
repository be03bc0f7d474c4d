#include "base/toml_file.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/error.hpp"
#include "base/suggest.hpp"

namespace brace {

toml::table parse_toml(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& e) {
    throw input_error("{}:{}: not valid TOML: {}", name, e.source().begin.line, e.description());
  }
}

toml::table read_toml_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw input_error("{}: is a folder; a TOML file is wanted", path.string());
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw input_error("{}: cannot be opened: no such file, or not readable", path.string());
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_toml(text.str(), path.string());
}

std::string place_of(const toml::node& node, const std::string& file) {
  const auto line = node.source().begin.line;
  return line == 0 ? file : fmt::format("{}:{}", file, line);
}

void reject_unknown_keys(const toml::table& table, const std::string& file, const std::string& where,
                         const std::vector<std::string>& known) {
  for (const auto& [key, value] : table) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw input_error("{}: unknown key '{}{}{}'{}; accepted here: {}", place_of(value, file), where,
                      where.empty() ? "" : ".", name, did_you_mean(name, known), join(known));
  }
}

}  // namespace brace
