#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace brace::sim {

inline constexpr std::string_view brace_trace_magic = "# brace pose trace 1";

std::string_view trimmed(std::string_view text);
std::vector<std::string_view> split_fields(std::string_view line, char separator);  // fields trimmed
std::vector<std::string_view> split_words(std::string_view line);                   // at blanks and tabs

/// A whole field as a number ("nan" and "inf" are numbers here), independent of the locale.
std::optional<double> parse_number(std::string_view field);
std::optional<std::int64_t> parse_integer(std::string_view field);

/// Decimal seconds as whole nanoseconds without a detour through double, which loses digits at epoch times;
/// digits below a nanosecond round to nearest. None where the text is no number or out of range; a time that
/// is NaN or infinite is none with `not_finite` set.
std::optional<std::int64_t> parse_seconds_as_ns(std::string_view field, bool& not_finite);

/// Lines of a text with their numbers, from 1; '\r' at the end is dropped.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}
  std::optional<std::string_view> next();
  std::size_t line() const { return line_; }

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

}  // namespace brace::sim
