#include "hmd_sim/text_fields.hpp"

#include <charconv>
#include <cmath>
#include <limits>

namespace brace::sim {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back()))
    text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> split_fields(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = line.find(separator);
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  while (!(line = trimmed(line)).empty()) {
    std::size_t end = 0;
    while (end < line.size() && !is_blank(line[end]))
      ++end;
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return words;
}

std::optional<double> parse_number(std::string_view field) {
  if (field.starts_with('+')) field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
  if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view field) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_seconds_as_ns(std::string_view field, bool& not_finite) {
  not_finite = false;
  const auto number = parse_number(field);
  if (!number) return std::nullopt;
  if (!std::isfinite(*number)) {
    not_finite = true;
    return std::nullopt;
  }
  if (std::abs(*number) > 4.6e9) return std::nullopt;
  if (field.find_first_of("eE") != std::string_view::npos) return std::llround(*number * 1e9);
  const bool negative = field.starts_with('-');
  const std::size_t point = field.find('.');
  std::int64_t ns = 0;
  for (const char c : field.substr(0, point)) {
    if (c >= '0' && c <= '9') ns = ns * 10 + (c - '0');
  }
  const std::string_view fraction = point == std::string_view::npos ? "" : field.substr(point + 1);
  for (std::size_t i = 0; i < 9; ++i)
    ns = ns * 10 + (i < fraction.size() ? fraction[i] - '0' : 0);
  if (fraction.size() > 9 && fraction[9] >= '5') ++ns;
  return negative ? -ns : ns;
}

std::optional<std::string_view> LineReader::next() {
  if (rest_.empty()) return std::nullopt;
  ++line_;
  const std::size_t end = rest_.find('\n');
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace brace::sim
