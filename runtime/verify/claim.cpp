#include "runtime/verify/claim.hpp"

#include <cmath>

#include <fmt/format.h>

namespace brace {

std::string figure_text(double figure) {
  if (figure == std::floor(figure) && std::abs(figure) < 1e9) return fmt::format("{:.0f}", figure);
  return fmt::format("{:.3g}", figure);
}

std::string to_string(const Bound& bound) {
  if (bound.low == bound.high) return "= " + figure_text(bound.low);
  if (std::isinf(bound.low)) return "≤ " + figure_text(bound.high);
  if (std::isinf(bound.high)) return "≥ " + figure_text(bound.low);
  return figure_text(bound.low) + " … " + figure_text(bound.high);
}

void Claims::add(std::string claim, double figure, Bound bound, std::string unit) {
  const bool passed = figure >= bound.low && figure <= bound.high;
  claims_.push_back({group_, std::move(claim), figure, std::move(unit), bound, passed});
  if (listener_) listener_(claims_.back());
}

}  // namespace brace
