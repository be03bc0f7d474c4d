// Accumulators, Beer–Lambert conversions, opacity correction and the integrals of transfer functions.
#include <cmath>

#include "runtime/verify/verify.hpp"

namespace brace {

namespace {

void verify_accumulators(const VerifySubjects& subjects, Claims& claims) {
  constexpr int forever = 1 << 20;
  const double alpha = 1e-3;
  const double left32 = 1 - subjects.accumulate(Accumulator::opacity, Precision::fp32, alpha, forever);
  claims.add("fp32, A += (1 − A) α stands still at 1 − A =  this × 2⁻²⁵/α (α = 0.001)",
             left32 / (std::ldexp(1, -25) / alpha), within(0.5, 2));
  claims.add("fp16, A += (1 − A) α stands still at A = (α = 0.001)",
             subjects.accumulate(Accumulator::opacity, Precision::fp16, alpha, forever), within(0.74, 0.77));
  claims.add("8 bit, A += (1 − A) α never leaves 0 (α = 0.001)",
             subjects.accumulate(Accumulator::opacity, Precision::fixed8, alpha, forever), exactly(0));
  constexpr int steps = 4096;
  const double thin = -std::expm1(-14.0 / steps), exact = std::exp(-14.0);
  const auto error = [&](Accumulator accumulator) {
    return std::abs(1 - subjects.accumulate(accumulator, Precision::fp32, thin, steps) - exact) / exact;
  };
  claims.add("fp32, 4096 steps to τ = 14: relative error of T by 1 − A", error(Accumulator::opacity),
             at_least(0.1));
  claims.add("fp32, the same by the product of T", error(Accumulator::transmittance), at_most(1e-3));
  claims.add("fp32, the same by the sum of τ", error(Accumulator::optical_depth), at_most(1e-4));
}

void verify_beer_lambert(const VerifySubjects& subjects, Claims& claims) {
  Largest back, split, corrected, chain, thin;
  for (int exponent = -12; exponent <= -1; ++exponent) {
    for (const double digit : {1.0, 3.0, 9.0}) {
      for (const double alpha : {digit * std::pow(10.0, exponent), 1 - digit * std::pow(10.0, exponent)}) {
        if (alpha <= 0 || alpha > 1 - 1e-7) continue;
        for (const double length : {1e-3, 1.0, 250.0}) {
          const double kappa = subjects.kappa_from_opacity(alpha, length);
          back.see(std::abs(subjects.opacity_from_kappa(kappa, length) - alpha) / alpha);
          const double first = subjects.opacity_from_kappa(kappa, 0.3 * length);
          const double second = subjects.opacity_from_kappa(kappa, 0.7 * length);
          split.see(std::abs(first + (1 - first) * second - alpha) / alpha);
        }
        for (const double rho : {1e-3, 0.5, 2.0, 1e3}) {
          const double other = subjects.opacity_corrected(alpha, rho);
          // What rounds to opaque cannot come back.
          if (other < 1 - 1e-6)
            corrected.see(std::abs(subjects.opacity_corrected(other, 1 / rho) - alpha) / alpha);
          chain.see(std::abs(subjects.opacity_corrected(subjects.opacity_corrected(alpha, 0.5), 0.25) -
                             subjects.opacity_corrected(alpha, 0.125)) /
                    alpha);
          if (alpha < 1e-6 && alpha * rho < 1e-6) thin.see(std::abs(other / (rho * alpha) - 1));
        }
      }
    }
  }
  claims.add("opacity → κ → opacity: largest relative error", back.value(), at_most(1e-8));
  claims.add("a segment split in 3 : 7 and composited: largest relative error", split.value(), at_most(1e-8));
  claims.add("opacity corrected by ρ and 1/ρ: largest relative error", corrected.value(), at_most(1e-6));
  claims.add("opacity corrected by ½ and ¼ is that by ⅛: largest relative error", chain.value(),
             at_most(1e-12));
  claims.add("opacity corrected → ρα as α → 0: largest relative error", thin.value(), at_most(1e-5));
  claims.add("opacity 1 stays 1 for ρ = 1e-6", subjects.opacity_corrected(1.0, 1e-6), exactly(1));
  claims.add("ρ = 0 gives opacity", subjects.opacity_corrected(1.0, 0.0), exactly(0));
}

void verify_splitting_on_device(const VerifySubjects& subjects, Claims& claims) {
  static const Volume slab = make_volume({9, 2, 2}, [](int, int, int) { return 1; });
  const auto table = make_table(
      2.0, min_table_entries, [](double) { return 0.4; }, [](double) { return 0.7; });
  for (const CastRule& rule : all_cast_rules()) {
    const std::vector<CastRay> rays = {{{0.5f, 1, 1, 8.0f}, {1, 0, 0, 0}},
                                       {{0.5f, 1, 1, 2.7f}, {1, 0, 0, 0}},
                                       {{3.2f, 1, 1, 5.3f}, {1, 0, 0, 0}}};
    const auto c = subjects.cast({&slab, table, rays, rule, SkipKind::none}).colours;
    const glm::vec4 both = c[1] + (1 - c[1].a) * c[2];
    claims.add("device, " + rule.name() + ": a slab split in two and composited: largest error",
               std::max(std::abs(both.r - c[0].r), std::abs(both.a - c[0].a)), at_most(2e-6));
  }
}

void verify_integrals(const VerifySubjects& subjects, Claims& claims) {
  const auto table = make_table(
      255.0, 256, [](double v) { return v > 100 && v < 130 ? v / 100 : 0.0; },
      [](double v) { return v / 255; });
  const TransferIntegrals sums = subjects.integrate(table, 0.5);
  double depth = 0.0, colour = 0.0;
  constexpr int pieces = 20'000;
  for (int i = 0; i < pieces; ++i) {
    const TransferSample here = lookup(table, 90.0 + 25.0 * (i + 0.5) / pieces);
    const double w = here.kappa * 0.5 / std::log(2.0) * 25.0 / pieces;
    depth += w;
    colour += w * here.r;
  }
  claims.add("transfer integrals over part of a band against 20,000 midpoints: relative error",
             std::max(std::abs(sums[115][3] - sums[90][3] - depth) / depth,
                      std::abs(sums[115][0] - sums[90][0] - colour) / colour),
             at_most(1e-6));
  claims.add("transfer integrals where nothing is visible: change",
             sums[90][3] - sums[0][3] + sums[255][3] - sums[140][3], exactly(0));
}

}  // namespace

void verify_absorption(const VerifySubjects& subjects, Claims& claims, VerifyFigures&) {
  verify_accumulators(subjects, claims);
  verify_beer_lambert(subjects, claims);
  verify_integrals(subjects, claims);
  verify_splitting_on_device(subjects, claims);
}

}  // namespace brace
