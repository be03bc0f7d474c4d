#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace brace::reference {

/// What a ray meets at one point: absorption per unit of length and colour, not premultiplied.
template <typename Real>
struct Medium {
  Real kappa = 0;
  std::array<Real, 3> colour{};
};

template <typename Real>
struct Integral {
  std::array<Real, 3> colour{};  // premultiplied
  Real opacity = 0;
  Real first_hit = std::numeric_limits<Real>::infinity();  // distance of the first sample with kappa > 0
  long samples = 0;
  long visible_samples = 0;
};

/// Emission and absorption along [0, length] by the exponential midpoint rule with steps of `step`, the last
/// one cut at the end. `medium(t)` gives the Medium at a distance. Ends when the opacity reaches
/// `termination` (1: never). The oracle of stages/cast/dvr, written once for every precision.
template <typename Real, typename MediumAt>
Integral<Real> integrate(Real length, Real step, Real termination, const MediumAt& medium) {
  Integral<Real> result;
  const Real segments = length / step;
  Real depth = 0;
  Real transmittance = 1;
  for (long i = 0; static_cast<Real>(i) < segments; ++i) {
    const Real part = std::min(segments - static_cast<Real>(i), Real(1));
    const Real t = (static_cast<Real>(i) + part / 2) * step;
    const Medium<Real> here = medium(t);
    ++result.samples;
    if (!(here.kappa > 0)) continue;
    ++result.visible_samples;
    result.first_hit = std::min(result.first_hit, t);
    depth += here.kappa * part * step;
    const Real left = std::exp(-depth);
    for (std::size_t c = 0; c < 3; ++c)
      result.colour[c] += here.colour[c] * (transmittance - left);
    transmittance = left;
    if (termination < 1 && transmittance <= 1 - termination) break;
  }
  result.opacity = -std::expm1(-depth);
  for (Real& c : result.colour)
    c = std::clamp(c, Real(0), result.opacity);
  return result;
}

}  // namespace brace::reference
