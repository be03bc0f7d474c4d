#include "runtime/sweep/sweep_file.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <tuple>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "base/toml_file.hpp"
#include "runtime/report/text_file.hpp"

namespace brace {

namespace {

struct KeyNode {
  std::string key;
  const toml::node* node;
};

bool is_table_key(const std::string& key) {
  return std::any_of(session_keys().begin(), session_keys().end(), [&](const SessionKey& info) {
    return key == info.name && info.type == std::string("table");
  });
}

void collect_keys(const toml::table& table, const std::string& prefix, std::vector<KeyNode>& found) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix + std::string(name.str());
    // `trace.neck = { … }` is a value; `trace.neck.motion = …` sets a part of it.
    if (node.is_table() && !(is_table_key(key) && node.as_table()->is_inline()))
      collect_keys(*node.as_table(), key + ".", found);
    else
      found.push_back({key, &node});
  }
}

/// Keys with their values in the order of the file: `pipeline.warp = x` and `"pipeline.warp" = x` are the
/// same. toml++ keeps tables by name.
std::vector<KeyNode> keys_in_order(const toml::table& table, const std::string& file) {
  std::vector<KeyNode> found;
  collect_keys(table, "", found);
  std::stable_sort(found.begin(), found.end(), [](const KeyNode& a, const KeyNode& b) {
    const toml::source_position x = a.node->source().begin, y = b.node->source().begin;
    return std::tie(x.line, x.column) < std::tie(y.line, y.column);
  });
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto same = [&](const KeyNode& other) { return other.key == found[i].key; };
    if (std::any_of(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(i), same))
      throw input_error("{}: '{}' is given twice", place_of(*found[i].node, file), found[i].key);
    if (found[i].key.find('.') == std::string::npos || found[i].key.back() == '.') {
      throw input_error("{}: '{}' is no session key; accepted: section.key as in pipeline.warp",
                        place_of(*found[i].node, file), found[i].key);
    }
    if (found[i].key.rfind("compare.", 0) == 0) {
      throw input_error("{}: '{}': a sweep compares by itself; give the values in [grid]",
                        place_of(*found[i].node, file), found[i].key);
    }
  }
  return found;
}

/// A value as TOML on one line: a table by itself would be printed as a file.
std::string value_text(const toml::node& node) {
  std::ostringstream text;
  if (node.is_table()) {
    toml::array list;
    list.push_back(*node.as_table());
    text << toml::toml_formatter(list,
                                 toml::toml_formatter::default_flags & ~toml::format_flags::indentation);
    const std::string in_brackets = text.str();
    const std::size_t begin = in_brackets.find('{');
    return in_brackets.substr(begin, in_brackets.rfind('}') + 1 - begin);
  }
  node.visit([&](const auto& concrete) { text << concrete; });
  return text.str();
}

SweepSetting setting_of(const std::string& key, const toml::node& node) {
  const std::string text = value_text(node);
  SweepSetting setting{key, text, text};
  if (const auto* integer = node.as_integer()) setting.value = integer->get();
  if (const auto* number = node.as_floating_point()) setting.value = number->get();
  if (const auto* plain = node.as_string()) setting.value = plain->get();
  return setting;
}

std::vector<SweepSetting> settings_of(const toml::table& table, const std::string& file) {
  std::vector<SweepSetting> settings;
  for (const KeyNode& entry : keys_in_order(table, file))
    settings.push_back(setting_of(entry.key, *entry.node));
  return settings;
}

const toml::table& table_at(const toml::table& top, const char* name, const std::string& file) {
  static const toml::table none;
  const toml::node* node = top.get(name);
  if (node == nullptr) return none;
  if (!node->is_table())
    throw input_error("{}: '{}' is a section: write [{}]", place_of(*node, file), name, name);
  return *node->as_table();
}

std::string text_at(const toml::table& top, const char* name, const std::string& file) {
  const toml::node* node = top.get(name);
  if (node == nullptr)
    throw input_error("{}: '{}' is missing: the session file that the points start from", file, name);
  const auto text = node->value<std::string>();
  if (!text || text->empty())
    throw input_error("{}: '{}' wants the name of a session file", place_of(*node, file), name);
  return *text;
}

std::int64_t repeat_of(const toml::table& top, const std::string& file) {
  const toml::node* node = top.get("repeat");
  if (node == nullptr) return 1;
  const auto* integer = node->as_integer();
  if (integer == nullptr || integer->get() < 1 || integer->get() > 10'000)
    throw input_error("{}: 'repeat' wants an integer; accepted: 1 to 10000", place_of(*node, file));
  return integer->get();
}

/// The key named by 'knob', one of those that vary; "" without it.
std::string knob_at(const toml::table& top, const std::vector<std::string>& keys, const std::string& file) {
  const toml::node* node = top.get("knob");
  if (node == nullptr) return "";
  const auto key = node->value<std::string>();
  if (!key || std::find(keys.begin(), keys.end(), *key) == keys.end()) {
    throw input_error("{}: 'knob' wants one of the keys that vary; accepted: {}", place_of(*node, file),
                      join(keys));
  }
  return *key;
}

using Settings = std::vector<SweepSetting>;

void check_count(std::size_t count, const std::string& file) {
  if (count > sweep_points_max)
    throw input_error("{}: the sweep has more than {} points", file, sweep_points_max);
}

/// Every combination of the grid's values, the last key fastest.
std::vector<Settings> grid_points(const toml::table& grid, const std::string& file) {
  std::vector<Settings> points{{}};
  for (const KeyNode& axis : keys_in_order(grid, file)) {
    const toml::array* values = axis.node->as_array();
    if (values == nullptr || values->empty()) {
      throw input_error("{}: '{}' in [grid] wants a list of values, as in [1, 2]", place_of(*axis.node, file),
                        axis.key);
    }
    check_count(points.size() * values->size(), file);
    std::vector<Settings> longer;
    for (const Settings& point : points) {
      for (const toml::node& value : *values) {
        longer.push_back(point);
        longer.back().push_back(setting_of(axis.key, value));
      }
    }
    points = std::move(longer);
  }
  return points;
}

/// The entries of [[point]]; one without settings if there are none.
std::vector<Settings> listed_points(const toml::table& top, const std::string& file) {
  const toml::node* node = top.get("point");
  if (node == nullptr) return {{}};
  if (!node->is_array_of_tables())
    throw input_error("{}: 'point' is a list of tables: write [[point]] for each", place_of(*node, file));
  std::vector<Settings> points;
  for (const toml::node& entry : *node->as_array())
    points.push_back(settings_of(*entry.as_table(), file));
  return points;
}

void add_keys(std::vector<std::string>& keys, const Settings& settings) {
  for (const SweepSetting& setting : settings) {
    if (std::find(keys.begin(), keys.end(), setting.key) == keys.end()) keys.push_back(setting.key);
  }
}

void refuse_double_keys(const Settings& grid, const Settings& listed, const std::string& file) {
  for (const SweepSetting& setting : listed) {
    const auto same = [&](const SweepSetting& other) { return other.key == setting.key; };
    if (std::any_of(grid.begin(), grid.end(), same))
      throw input_error("{}: '{}' is in [grid] and in [[point]]; accepted: one of them", file, setting.key);
  }
}

}  // namespace

std::string to_text(const SweepValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  return std::to_string(std::get<std::int64_t>(value));
}

SweepFile parse_sweep(const std::string& text, const std::filesystem::path& file) {
  const std::string name = file.string();
  const toml::table top = parse_toml(text, name);
  reject_unknown_keys(top, name, "", {"session", "repeat", "knob", "set", "grid", "point"});
  SweepFile sweep;
  sweep.file = file;
  sweep.session =
      (std::filesystem::absolute(file).parent_path() / text_at(top, "session", name)).lexically_normal();
  sweep.repeat = repeat_of(top, name);
  const Settings common = settings_of(table_at(top, "set", name), name);
  const std::vector<Settings> grid = grid_points(table_at(top, "grid", name), name);
  const std::vector<Settings> listed = listed_points(top, name);
  check_count(grid.size() * listed.size(), name);
  add_keys(sweep.keys, grid.front());
  for (const Settings& entry : listed) {
    refuse_double_keys(grid.front(), entry, name);
    add_keys(sweep.keys, entry);
  }
  if (sweep.keys.empty())
    throw input_error("{}: there is nothing to vary; accepted: [grid], [[point]]", name);
  sweep.knob = knob_at(top, sweep.keys, name);
  for (const Settings& entry : listed) {
    for (const Settings& point : grid) {
      SweepPoint all{fmt::format("{}: point {}", name, sweep.points.size() + 1), common};
      all.settings.insert(all.settings.end(), entry.begin(), entry.end());
      all.settings.insert(all.settings.end(), point.begin(), point.end());
      sweep.points.push_back(std::move(all));
    }
  }
  return sweep;
}

SweepFile read_sweep(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw input_error("{}: is a folder; a sweep is a TOML file", file.string());
  if (!std::filesystem::exists(file, ignored))
    throw input_error("{}: cannot be opened: no such sweep file", file.string());
  return parse_sweep(read_text_file(file), file);
}

}  // namespace brace
