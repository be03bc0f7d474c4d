#include "runtime/session/session_table.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/suggest.hpp"

namespace brace {

namespace {

const SessionKey& key_info(const std::string& key) {
  for (const SessionKey& info : session_keys()) {
    if (key == info.name) return info;
  }
  BRACE_CHECK(false);
  std::abort();
}

bool is_stage_key(const std::string& section) {
  return section == "stage";
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

std::vector<std::string> sections() {
  std::vector<std::string> names;
  for (const SessionKey& info : session_keys()) {
    const std::string section = split(info.name, '.')[0];
    if (names.empty() || names.back() != section) names.push_back(section);
  }
  names.emplace_back("stage");
  return names;
}

std::vector<std::string> keys_of(const std::string& section) {
  std::vector<std::string> names;
  for (const SessionKey& info : session_keys()) {
    const auto parts = split(info.name, '.');
    if (parts[0] == section) names.push_back(parts[1]);
  }
  return names;
}

std::string with_article(const std::string& type) {
  if (type == "tables") return "a list of tables";
  return (type == "integer" ? "an " : "a ") + type;
}

bool has_type(const toml::node& node, const std::string& type) {
  if (type == "text") return node.is_string();
  if (type == "number") return node.is_number();
  if (type == "integer") return node.is_integer();
  if (type == "flag") return node.is_boolean();
  if (type == "table") return node.is_table();
  if (type == "tables") return node.is_array_of_tables();
  return node.is_array();
}

void assign(toml::table& table, const std::string& key, const toml::node& value) {
  value.visit([&](const auto& concrete) { table.insert_or_assign(key, concrete); });
}

}  // namespace

SessionTable::SessionTable(toml::table table, std::string file)
    : table_(std::move(table)), file_(std::move(file)) {}

void SessionTable::set(const std::string& key, const std::string& value) {
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value);
    if (parsed.size() != 1) {  // more than a value: words, then
      parsed.clear();
      parsed.insert_or_assign("value", value);
    }
  } catch (const toml::parse_error&) {
    parsed.insert_or_assign("value", value);  // --set device.profile=htc-vive needs no quotes
  }
  const std::vector<std::string> parts = split(key, '.');
  if (parts.size() < 2 || parts.back().empty()) {
    throw input_error("--set {}: a key is written section.key, as in device.profile", key);
  }
  toml::table* table = &table_;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    toml::node* next = table->get(parts[i]);
    if (next == nullptr) next = &table->insert_or_assign(parts[i], toml::table()).first->second;
    if (!next->is_table()) throw input_error("--set {}: '{}' is not a table", key, parts[i]);
    table = next->as_table();
  }
  assign(*table, parts.back(), *parsed.get("value"));
  overridden_.push_back(key);
}

void SessionTable::put(const std::string& key, const std::string& value) {
  const std::vector<std::string> parts = split(key, '.');
  const toml::table parsed = toml::parse("value = " + value);
  assign(*table_[parts[0]].as_table(), parts[1], *parsed.get("value"));
}

void SessionTable::put_of_stage(const std::string& stage, const std::string& parameter,
                                const std::string& value) {
  toml::table& all = *table_.insert("stage", toml::table()).first->second.as_table();
  toml::table& own = *all.insert(stage, toml::table()).first->second.as_table();
  const toml::table parsed = toml::parse("value = " + value);
  assign(own, parameter, *parsed.get("value"));
}

void SessionTable::check_and_complete() {
  reject_unknown_keys(table_, file_, "", sections());
  for (const auto& [section, node] : table_) {
    if (!node.is_table()) {
      throw input_error("{}: '{}' is a section: write [{}]", place_of(node, file_), section.str(),
                        section.str());
    }
    if (is_stage_key(std::string(section.str()))) continue;
    reject_unknown_keys(*node.as_table(), file_, std::string(section.str()),
                        keys_of(std::string(section.str())));
  }
  for (const SessionKey& info : session_keys()) {
    const toml::node* found = node(info.name);
    if (found != nullptr && !has_type(*found, info.type)) {
      fail(info.name, fmt::format("wants {}{}{}", with_article(info.type),
                                  info.accepted[0] == '\0' ? "" : ": ", info.accepted));
    }
    if (found != nullptr || info.fallback[0] == '\0') continue;
    const auto parts = split(info.name, '.');
    toml::node* section = table_.get(parts[0]);
    if (section == nullptr) section = &table_.insert_or_assign(parts[0], toml::table()).first->second;
    const toml::table fallback = toml::parse(std::string("value = ") + info.fallback);
    assign(*section->as_table(), parts[1], *fallback.get("value"));
  }
}

const toml::node* SessionTable::node(const std::string& key) const {
  return table_.at_path(key).node();
}

std::string SessionTable::place(const std::string& key) const {
  if (std::find(overridden_.begin(), overridden_.end(), key) != overridden_.end()) return "--set " + key;
  const toml::node* found = node(key);
  return found == nullptr ? file_ : place_of(*found, file_);
}

void SessionTable::fail(const std::string& key, const std::string& what) const {
  throw input_error("{}: '{}' {}", place(key), key, what);
}

std::optional<std::string> SessionTable::optional_text(const std::string& key) const {
  const toml::node* found = node(key);
  if (found == nullptr) return std::nullopt;
  return found->value<std::string>();
}

std::optional<double> SessionTable::optional_number(const std::string& key) const {
  const toml::node* found = node(key);
  if (found == nullptr) return std::nullopt;
  const auto value = found->value<double>();
  if (!value || !std::isfinite(*value)) fail(key, "wants a finite number");
  return value;
}

std::string SessionTable::text(const std::string& key) const {
  const auto value = optional_text(key);
  if (!value || value->empty()) fail(key, std::string("is missing: ") + key_info(key).help);
  return *value;
}

double SessionTable::number(const std::string& key) const {
  const auto value = optional_number(key);
  if (!value) fail(key, std::string("is missing: ") + key_info(key).help);
  return *value;
}

std::int64_t SessionTable::integer(const std::string& key) const {
  const toml::node* found = node(key);
  BRACE_CHECK(found != nullptr);
  return found->value_or(std::int64_t{0});
}

bool SessionTable::flag(const std::string& key) const {
  return table_.at_path(key).value_or(false);
}

std::string SessionTable::choice(const std::string& key) const {
  std::string value = text(key);
  const std::vector<std::string> choices = split(key_info(key).accepted, '|');
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return value;
  fail(key, fmt::format("is '{}'{}; accepted: {}", value, did_you_mean(value, choices), join(choices)));
}

double SessionTable::number_in(const std::string& key, double minimum, double maximum) const {
  const double value = number(key);
  if (value >= minimum && value <= maximum) return value;
  fail(key, fmt::format("is {}; accepted: {}", value, key_info(key).accepted));
}

}  // namespace brace
