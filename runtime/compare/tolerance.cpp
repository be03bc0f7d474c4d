#include "runtime/compare/tolerance.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.hpp"
#include "runtime/compare/compare_records.hpp"

namespace brace {

namespace {

double parse_amount(const std::string& text, std::string_view number) {
  double value = 0;
  const auto result = std::from_chars(number.data(), number.data() + number.size(), value);
  const bool whole = result.ec == std::errc() && result.ptr == number.data() + number.size();
  if (whole && std::isfinite(value) && value >= 0) return value;
  throw input_error(
      "--tolerance {}: '{}' is no tolerance; accepted: a number >= 0 in the figure's unit, or a share such "
      "as "
      "5%",
      text, number);
}

}  // namespace

double Tolerance::of(double a) const {
  return std::max(absolute, relative * std::abs(a));
}

ToleranceChoice parse_tolerance(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    throw input_error("--tolerance {}: accepted: FIGURE=VALUE, e.g. --tolerance dssim=0.002", text);
  }
  ToleranceChoice choice;
  const std::string name = text.substr(0, equals);
  const std::size_t dot = name.find('.');
  choice.figure = name.substr(0, dot);
  if (dot != std::string::npos) choice.statistic = name.substr(dot + 1);
  require_compared_figure("--tolerance " + text, choice.figure, choice.statistic);
  std::string_view amount = std::string_view(text).substr(equals + 1);
  if (amount.ends_with('%')) {
    amount.remove_suffix(1);
    choice.tolerance.relative = parse_amount(text, amount) / 100.0;
  } else {
    choice.tolerance.absolute = parse_amount(text, amount);
  }
  return choice;
}

Tolerance tolerance_of(std::span<const ToleranceChoice> choices, std::string_view figure,
                       std::string_view statistic, const Tolerance& standard) {
  Tolerance tolerance = standard;
  for (const ToleranceChoice& choice : choices) {
    if (choice.figure != figure) continue;
    if (choice.statistic.empty() || choice.statistic == statistic) tolerance = choice.tolerance;
  }
  return tolerance;
}

}  // namespace brace
