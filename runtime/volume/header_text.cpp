#include "runtime/volume/header_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <span>
#include <utility>

#include "base/error.hpp"
#include "runtime/volume/byte_stream.hpp"

namespace brace {
namespace {

constexpr std::size_t longest_header_bytes = std::size_t{1} << 20;

bool is_blank(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

}  // namespace

HeaderLines::HeaderLines(const std::filesystem::path& path) : path_(path) {
  const std::uint64_t file_bytes = regular_file_size(path);
  text_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(file_bytes, longest_header_bytes)));
  const auto stream = open_file_stream(path, 0);
  text_.resize(stream->read(std::as_writable_bytes(std::span(text_))));
}

std::optional<std::string_view> HeaderLines::next() {
  if (offset_ >= text_.size()) return std::nullopt;
  ++line_;
  const std::size_t end = text_.find('\n', offset_);
  std::string_view line =
      std::string_view(text_).substr(offset_, end == std::string::npos ? end : end - offset_);
  offset_ = end == std::string::npos ? text_.size() : end + 1;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string HeaderLines::place() const {
  return fmt::format("{}:{}", path_.string(), line_);
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back()))
    text.remove_suffix(1);
  return text;
}

std::string lowered(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> result;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const auto end = std::find_if(text.begin(), text.end(), is_blank);
    result.push_back(text.substr(0, static_cast<std::size_t>(end - text.begin())));
    text.remove_prefix(result.back().size());
  }
  return result;
}

std::int64_t parse_integer(std::string_view text, const std::string& where) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) throw input_error("{}: {} is too large", where, text);
  if (error != std::errc{} || end != text.data() + text.size())
    throw input_error("{}: '{}' is not an integer", where, text);
  return value;
}

double parse_number(std::string_view text, const std::string& where) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw input_error("{}: '{}' is not a number", where, text);
  return value;
}

std::filesystem::path data_file_beside(const std::filesystem::path& header, std::string_view name) {
  return header.parent_path() / std::filesystem::path(std::string(name));
}

std::optional<StoredType> stored_type_of(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, StoredType>, 10> table{{
      {"int8", StoredType::int8},
      {"uint8", StoredType::uint8},
      {"int16", StoredType::int16},
      {"uint16", StoredType::uint16},
      {"int32", StoredType::int32},
      {"uint32", StoredType::uint32},
      {"int64", StoredType::int64},
      {"uint64", StoredType::uint64},
      {"float32", StoredType::float32},
      {"float64", StoredType::float64},
  }};
  for (const auto& [known, type] : table)
    if (known == name) return type;
  return std::nullopt;
}

}  // namespace brace
