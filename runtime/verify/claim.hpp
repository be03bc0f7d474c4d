#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace brace {

/// The interval that a figure must lie in, ends included.
struct Bound {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};
inline Bound at_most(double high) {
  return {.high = high};
}
inline Bound at_least(double low) {
  return {.low = low};
}
inline Bound within(double low, double high) {
  return {low, high};
}
inline Bound exactly(double value) {
  return {value, value};
}

/// One line of the verification: what is claimed, what was found, what is allowed.
struct Claim {
  std::string group;
  std::string claim;
  double figure = 0.0;
  std::string unit;
  Bound bound;
  bool passed = false;  // NaN never passes
};

/// "<= 1e-12", "1.8 … 2.2", "= 0".
std::string to_string(const Bound& bound);
std::string figure_text(double figure);

/// Collects claims of one group.
class Claims {
 public:
  using Listener = std::function<void(const Claim&)>;
  explicit Claims(std::string group, Listener listener = {})
      : group_(std::move(group)), listener_(std::move(listener)) {}

  void add(std::string claim, double figure, Bound bound, std::string unit = "");
  std::vector<Claim> take() { return std::move(claims_); }

 private:
  std::string group_;
  Listener listener_;
  std::vector<Claim> claims_;
};

/// Largest value seen; NaN sticks.
class Largest {
 public:
  void see(double value) {
    if (value_ <= value_ && !(value <= value_)) value_ = value;
  }
  double value() const { return value_; }

 private:
  double value_ = 0.0;
};

}  // namespace brace
