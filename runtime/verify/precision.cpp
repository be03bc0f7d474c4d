#include "runtime/verify/precision.hpp"

#include <algorithm>
#include <cmath>

namespace brace {

namespace {

constexpr double kColourFirst = 0.2, kColourLast = 0.8;
constexpr int kSteps = 32;

/// A number that is rounded after every operation.
class Rounded {
 public:
  Rounded(double value, Precision precision) : value_(rounded(value, precision)), precision_(precision) {}
  double value() const { return value_; }
  Precision precision() const { return precision_; }

  friend Rounded operator+(Rounded a, Rounded b) { return {a.value_ + b.value_, a.precision_}; }
  friend Rounded operator-(Rounded a, Rounded b) { return {a.value_ - b.value_, a.precision_}; }
  friend Rounded operator*(Rounded a, Rounded b) { return {a.value_ * b.value_, a.precision_}; }
  friend Rounded operator/(Rounded a, Rounded b) { return {a.value_ / b.value_, a.precision_}; }

 private:
  double value_;
  Precision precision_;
};

Rounded exp_minus(Rounded x) {
  return {std::exp(-x.value()), x.precision()};
}

/// Where in a step of optical depth x the mean of what it shows lies: 1/x - 1/(exp(x) - 1).
Rounded mean_place(Rounded x) {
  const Precision p = x.precision();
  if (x.value() < 0.5) return Rounded(0.5, p) - x * Rounded(1.0 / 12, p);
  return Rounded(1, p) / x - Rounded(1 / std::expm1(x.value()), p);
}

struct Ray {
  Rounded depth, transmittance, colour;
};

void step(StabilityRule rule, Rounded x, double first, double last, Ray& ray) {
  const Precision p = x.precision();
  const Rounded one(1, p), middle((first + last) / 2, p), front(first, p);
  const auto exponential = [&](Rounded shown) {
    ray.depth = ray.depth + x;
    const Rounded left = exp_minus(ray.depth);
    ray.colour = ray.colour + (ray.transmittance - left) * shown;
    ray.transmittance = left;
  };
  switch (rule) {
    case StabilityRule::euler:
      ray.colour = ray.colour + ray.transmittance * x * middle;
      ray.transmittance = ray.transmittance * (one - x);
      return;
    case StabilityRule::thesis:
      ray.colour = ray.colour + ray.transmittance * x * middle;
      ray.transmittance = ray.transmittance * exp_minus(x);
      return;
    case StabilityRule::crank_nicolson: {
      const Rounded half = x * Rounded(0.5, p);
      const Rounded left = ray.transmittance * (one - half) / (one + half);
      ray.colour = ray.colour + (ray.transmittance - left) * middle;
      ray.transmittance = left;
      return;
    }
    case StabilityRule::exponential_left:
      return exponential(front);
    case StabilityRule::exponential_midpoint:
      return exponential(middle);
    case StabilityRule::linear_source:
      return exponential(front + mean_place(x) * Rounded(last - first, p));
  }
}

/// C = c0 (1 - e^-X) + (c1 - c0) (1 - e^-X (1 + X)) / X over the whole optical depth X.
double exact_colour(double x) {
  const double depth = x * kSteps;
  const double gone = -std::expm1(-depth);
  const double slope = depth < 1e-4 ? depth / 2 : (gone - depth * std::exp(-depth)) / depth;
  return kColourFirst * gone + (kColourLast - kColourFirst) * slope;
}

double to_half(double value) {
  const double size = std::abs(value);
  if (!(size > 0)) return value;
  if (size >= 65520) return std::copysign(INFINITY, value);
  int exponent = 0;
  std::frexp(size, &exponent);
  const double unit = std::ldexp(1.0, std::max(exponent, -13) - 11);  // subnormal below 2^-14
  return std::nearbyint(value / unit) * unit;
}

}  // namespace

double rounded(double value, Precision precision) {
  switch (precision) {
    case Precision::fp32:
      // Beyond the largest float a conversion would be undefined.
      if (std::abs(value) > 3.5e38) return std::copysign(INFINITY, value);
      return static_cast<double>(static_cast<float>(value));
    case Precision::fp16:
      return std::isfinite(value) ? to_half(value) : value;
    case Precision::fixed8:
      return std::nearbyint(std::clamp(value, 0.0, 1.0) * 255) / 255;
  }
  return value;
}

std::string to_string(StabilityRule rule) {
  switch (rule) {
    case StabilityRule::euler:
      return "explicit Euler";
    case StabilityRule::thesis:
      return "colour e Δt";
    case StabilityRule::crank_nicolson:
      return "Crank–Nicolson";
    case StabilityRule::exponential_left:
      return "exponential, left";
    case StabilityRule::exponential_midpoint:
      return "exponential, midpoint";
    case StabilityRule::linear_source:
      return "exponential, linear source";
  }
  return "";
}

StabilityRun run_stability(StabilityRule rule, Precision precision, double x) {
  Ray ray{{0, precision}, {1, precision}, {0, precision}};
  StabilityRun run{true, 0};
  constexpr double slack = 2e-3;  // sums of halves round by as much
  for (int i = 0; i < kSteps; ++i) {
    const double slope = (kColourLast - kColourFirst) / kSteps;
    step(rule, {x, precision}, kColourFirst + slope * i, kColourFirst + slope * (i + 1), ray);
    const double t = ray.transmittance.value(), c = ray.colour.value();
    run.bounded = run.bounded && t >= 0 && t <= 1 && c >= 0 && c <= kColourLast + slack;
  }
  run.error = std::abs(ray.colour.value() - exact_colour(x));
  return run;
}

double accumulate(Accumulator accumulator, Precision precision, double alpha, int steps) {
  const Rounded one(1, precision), a(alpha, precision);
  Rounded value(accumulator == Accumulator::transmittance ? 1 : 0, precision);
  const Rounded depth(-std::log1p(-alpha), precision);
  for (int i = 0; i < steps; ++i) {
    const Rounded before = value;
    if (accumulator == Accumulator::opacity) value = value + (one - value) * a;
    if (accumulator == Accumulator::transmittance) value = value * (one - a);
    if (accumulator == Accumulator::optical_depth) value = value + depth;
    if (value.value() == before.value()) break;
  }
  if (accumulator == Accumulator::opacity) return value.value();
  if (accumulator == Accumulator::transmittance) return 1 - value.value();
  return -std::expm1(-value.value());
}

}  // namespace brace
