#include "hmd_sim/lens.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hmd_sim/polynomial.hpp"

namespace brace::sim {
namespace {

using Coefficients = std::array<double, 5>;

// Brown-Conrady's series and the denominator of the rational model: 1 + k0 r^2 + k1 r^4 + k2 r^6.
double even_series(const Coefficients& k, double r) {
  const double r2 = r * r;
  return 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]));
}

double even_series_derivative(const Coefficients& k, double r) {
  const double r2 = r * r;
  return r * (2.0 * k[0] + r2 * (4.0 * k[1] + r2 * 6.0 * k[2]));
}

Polynomial even_polynomial(const Coefficients& k) {
  return {1.0, 0.0, k[0], 0.0, k[1], 0.0, k[2]};
}

/// Of the hyperbola r L0 / (1 - b r / r_max) that leaves 0 with the model's slope L0 and ends where it ends:
/// a straight line would start a model that grows towards a pole far from every root.
double first_guess(double scale_0, double source_radius, double r_max, double source_max) {
  if (!(source_max > 0.0) || !(scale_0 > 0.0)) return 0.0;
  const double b = 1.0 - r_max * scale_0 / source_max;
  return std::min(r_max, source_radius / (scale_0 + b * source_radius / r_max));
}

}  // namespace

std::string_view to_string(LensKind kind) {
  switch (kind) {
    case LensKind::none_published:
      return "none_published";
    case LensKind::identity:
      return "identity";
    case LensKind::brown_conrady:
      return "brown_conrady";
    case LensKind::panotools:
      return "panotools";
    case LensKind::vive:
      return "vive";
  }
  return "unknown";
}

EyeLens identity_lens(const FovTangents& fov) {
  EyeLens lens;
  lens.kind = LensKind::identity;
  lens.panel_size_units = {1.0, 1.0};
  lens.tan_per_unit = {fov.width(), fov.height()};
  for (LensChannel& channel : lens.rgb) {
    channel.centre_uv = {-fov.left / fov.width(), fov.top / fov.height()};
  }
  return lens;
}

double lens_scale(LensKind kind, const Coefficients& k, double r) {
  switch (kind) {
    case LensKind::none_published:
    case LensKind::identity:
      return 1.0;
    case LensKind::brown_conrady:
      return even_series(k, r);
    case LensKind::panotools:
      return k[0] + r * (k[1] + r * (k[2] + r * (k[3] + r * k[4])));
    case LensKind::vive:
      return 1.0 / even_series(k, r) + k[3];
  }
  return 1.0;
}

double lens_scale_derivative(LensKind kind, const Coefficients& k, double r) {
  switch (kind) {
    case LensKind::none_published:
    case LensKind::identity:
      return 0.0;
    case LensKind::brown_conrady:
      return even_series_derivative(k, r);
    case LensKind::panotools:
      return k[1] + r * (2.0 * k[2] + r * (3.0 * k[3] + r * 4.0 * k[4]));
    case LensKind::vive: {
      const double series = even_series(k, r);
      return -even_series_derivative(k, r) / (series * series);
    }
  }
  return 0.0;
}

double lens_forward(LensKind kind, const Coefficients& k, double r) {
  return r * lens_scale(kind, k, r);
}

double fold_over_radius(LensKind kind, const Coefficients& k, double r_max) {
  // d(rL)/dr = 0 is where r L'/L = -1; L = 0 comes after it, as r L is 0 at r = 0 and must come down again.
  switch (kind) {
    case LensKind::none_published:
    case LensKind::identity:
      return r_max;
    case LensKind::brown_conrady:
      return first_nonpositive(derivative(times_x(even_polynomial(k))), r_max);
    case LensKind::panotools:
      return first_nonpositive(derivative(times_x({k[0], k[1], k[2], k[3], k[4]})), r_max);
    case LensKind::vive: {
      // d(r/S + k3 r)/dr = (S - r S' + k3 S^2) / S^2, up to the pole S = 0.
      const Polynomial series = even_polynomial(k);
      double pole = first_nonpositive(series, r_max);
      // On the pole or a rounding past it r L(r) is no large positive number but none, or a negative one.
      while (pole > 0.0 && !(even_series(k, pole) > 0.0))
        pole = std::nextafter(pole, 0.0);
      const Polynomial slope =
          sum(sum(series, scaled(times_x(derivative(series)), -1.0)), scaled(product(series, series), k[3]));
      return first_nonpositive(slope, pole);
    }
  }
  return r_max;
}

std::optional<double> lens_inverse(LensKind kind, const Coefficients& k, double source_radius,
                                   double usable_radius, int* iterations) {
  if (iterations != nullptr) *iterations = 0;
  if (!(source_radius >= 0.0) || !(usable_radius >= 0.0)) return std::nullopt;
  if (kind == LensKind::none_published || kind == LensKind::identity) {
    if (source_radius > usable_radius) return std::nullopt;
    return source_radius;
  }
  BRACE_CHECK(std::isfinite(usable_radius));
  const double source_max = lens_forward(kind, k, usable_radius);
  if (source_radius > source_max) {
    // What the rim itself maps to may have been rounded up on its way here.
    if (source_radius <= source_max * (1.0 + 1e-13)) return usable_radius;
    return std::nullopt;
  }
  double low = 0.0, high = usable_radius;
  double r = first_guess(lens_scale(kind, k, 0.0), source_radius, usable_radius, source_max);
  constexpr int iterations_max = 100;  // bisection alone ends within 64
  for (int i = 0; i < iterations_max; ++i) {
    if (iterations != nullptr) *iterations = i + 1;
    const double scale = lens_scale(kind, k, r);
    const double residual = r * scale - source_radius;
    const double slope = scale + r * lens_scale_derivative(kind, k, r);
    double step = residual / slope;
    // Towards a pole the reciprocal is nearly straight, and its Newton step does not shoot past the root.
    if (kind == LensKind::vive && residual < 0.0 && r > 0.0) step *= r * scale / source_radius;
    // Step convergence first: at the root the rounding of the residual may put the next point outside the
    // bracket, and a bracket test first would then bisect for ever.
    if (std::abs(step) <= 1e-15 * (1.0 + r)) return std::clamp(r - step, 0.0, usable_radius);
    (residual > 0.0 ? high : low) = r;
    const double newton = r - step;
    r = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (high - low <= 1e-15 * (1.0 + r)) return r;
  }
  return r;
}

}  // namespace brace::sim
