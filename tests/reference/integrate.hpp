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

/// Emission and absorption along [0, length] by the exponential rule of one sample per step, which lies at
/// `place` of it (the middle, or 0 for the left rule), with steps of `step`, the last one cut at the end.
/// `medium(t)` gives the Medium at a distance. Ends when the opacity reaches `termination` (1: never). The
/// oracle of stages/cast/dvr, written once for every precision.
template <typename Real, typename MediumAt>
Integral<Real> integrate(Real length, Real step, Real termination, const MediumAt& medium,
                         Real place = Real(0.5)) {
  Integral<Real> result;
  const Real segments = length / step;
  Real depth = 0;
  Real transmittance = 1;
  for (long i = 0; static_cast<Real>(i) < segments; ++i) {
    const Real part = std::min(segments - static_cast<Real>(i), Real(1));
    const Real t = (static_cast<Real>(i) + part * place) * step;
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

/// What a segment between two distances does by itself: optical depth (of base e), and the colour that it
/// adds per unit of the transmittance it takes away.
template <typename Real>
struct Segment {
  Real depth = 0;
  std::array<Real, 3> colour{};
};

/// The same between samples: segment(begin, end) gives a Segment.
template <typename Real, typename SegmentBetween>
Integral<Real> integrate_between(Real length, Real step, Real termination, const SegmentBetween& segment) {
  Integral<Real> result;
  Real depth = 0;
  Real transmittance = 1;
  result.samples = 1;
  for (long i = 0; static_cast<Real>(i) * step < length; ++i) {
    const Real begin = static_cast<Real>(i) * step;
    const Real end = std::min(static_cast<Real>(i + 1) * step, length);
    const Segment<Real> here = segment(begin, end);
    ++result.samples;
    if (!(here.depth > 0)) continue;
    ++result.visible_samples;
    result.first_hit = std::min(result.first_hit, (begin + end) / 2);
    depth += here.depth;
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

/// kappa by the trapezoid, colour linear: the exact solution of C' = kappa (c0 + (c1 - c0) t / length) T for
/// constant kappa, from the integrals of exp(-x s) and s exp(-x s) over [0, 1].
template <typename Real>
Segment<Real> linear_source(const Medium<Real>& front, const Medium<Real>& back, Real length) {
  Segment<Real> segment;
  const Real x = (front.kappa + back.kappa) / 2 * length;
  segment.depth = x;
  const Real gone = -std::expm1(-x);
  // x times the integral of s exp(-x s), over 1 - exp(-x); its series where it cancels.
  const Real place = x < Real(1e-3) ? Real(0.5) - x / 12 : (gone - x * std::exp(-x)) / (x * gone);
  for (std::size_t c = 0; c < 3; ++c)
    segment.colour[c] = front.colour[c] + place * (back.colour[c] - front.colour[c]);
  return segment;
}

/// A value that goes linearly from `front` to `back` through medium_of(value): by very many midpoint steps.
template <typename Real, typename MediumOf>
Segment<Real> pre_integrated(Real front, Real back, Real length, const MediumOf& medium_of, int pieces) {
  Segment<Real> segment;
  std::array<Real, 3> colour{};
  Real transmittance = 1;
  for (int i = 0; i < pieces; ++i) {
    const Real place = (static_cast<Real>(i) + Real(0.5)) / static_cast<Real>(pieces);
    const Medium<Real> here = medium_of(front + place * (back - front));
    segment.depth += here.kappa * length / static_cast<Real>(pieces);
    const Real left = std::exp(-segment.depth);
    for (std::size_t c = 0; c < 3; ++c)
      colour[c] += here.colour[c] * (transmittance - left);
    transmittance = left;
  }
  const Real gone = -std::expm1(-segment.depth);
  for (std::size_t c = 0; c < 3; ++c)
    segment.colour[c] = gone > 0 ? colour[c] / gone : Real(0);
  return segment;
}

}  // namespace brace::reference
