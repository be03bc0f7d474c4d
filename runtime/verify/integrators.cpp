// Observed orders of cast/dvr's integrators on exact solutions, on the device at hand.
#include <cmath>
#include <numbers>

#include "runtime/verify/verify.hpp"

namespace brace {

namespace {

constexpr int kLength = 16;

/// A ray along which the table's coordinate is the distance; red is what it shows.
struct Problem {
  std::string name;
  TransferTable table;
  double exact = 0.0;
};

std::vector<Problem> problems() {
  const double size = kLength, pi = std::numbers::pi;
  const double k0 = 0.5, l = 5.0, k = 0.18, sigma = 2.5, mu = 6.4, s = std::numbers::sqrt2 * sigma;
  const auto bump = [=](double t) { return 0.4 * std::exp(-(t - mu) * (t - mu) / (s * s)); };
  const auto tau = [=](double t) {
    return 0.4 * sigma * std::sqrt(pi / 2) * (std::erf((t - mu) / s) + std::erf(mu / s));
  };
  const auto fading = [=](double t) { return k0 * std::exp(-t / l); };
  const double c3 = fading(size), c5 = 1 / tau(size), left = std::exp(-k * size);
  const auto table = [&](const auto& kappa, const auto& colour) {
    return make_table(size, max_table_entries, kappa, colour);
  };
  return {
      {"P3 (κ falls exponentially, e constant)", table(fading, [&](double t) { return c3 / fading(t); }),
       c3 * l * std::exp(-k0 * l) * (std::expint(k0 * l) - std::expint(k0 * l * std::exp(-size / l)))},
      {"P4 (κ = 1/(1+t), e constant)",
       table([](double t) { return 1 / (1 + t); }, [&](double t) { return (1 + t) / (1 + size); }),
       std::log(1 + size) / (1 + size)},
      {"P5 (Gaussian κ, c = τ)", table(bump, [&](double t) { return c5 * tau(t); }),
       c5 * (1 - std::exp(-tau(size)) * (1 + tau(size)))},
      {"P6 (κ constant, c linear)", table([&](double) { return k; }, [](double t) { return 0.1 + 0.05 * t; }),
       0.1 * (1 - left) + 0.05 * (1 - left * (1 + k * size)) / k},
  };
}

const Volume& ramp() {
  static const Volume volume = make_volume({kLength + 1, 2, 2}, [](int x, int, int) { return x; });
  return volume;
}

double shown(const VerifySubjects& subjects, const TransferTable& table, CastRule rule, double step) {
  rule.step_voxels = step;
  const CastRay ray{{0.5f, 1.0f, 1.0f, float(kLength)}, {1, 0, 0, 0}};
  return static_cast<double>(subjects.cast({&ramp(), table, {ray}, rule, SkipKind::none}).colours[0].r);
}

void verify_orders(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures) {
  for (const Problem& problem : problems()) {
    const bool linear_colour = problem.name.substr(0, 2) == "P6";
    for (const CastRule& rule : all_cast_rules()) {
      ErrorCurve curve{problem.name, rule.name(), {}};
      double coarse = 0.0, fine = 0.0;
      for (const double step : {2.0, 1.0, 0.5}) {
        coarse = fine;
        fine = std::abs(shown(subjects, problem.table, rule, step) - problem.exact);
        curve.points.push_back({kLength / step, fine});
      }
      figures.curves.push_back(curve);
      const std::string name = rule.name() + ", " + problem.name;
      if (rule.integrator == "linear-source" && linear_colour) {
        claims.add(name + ": exact", fine, at_most(2e-6));
      } else if (rule.integrator == "pre-integrated" && rule.preintegration == "table") {
        // The value is linear here and the order within a step is kept: only the table's grid is left.
        claims.add(name + ": error at 8 steps", curve.points.front()[1], at_most(1e-3));
      } else if (rule.integrator == "left" && problem.name.substr(0, 2) == "P5") {
        // The left rule's leading error is what the ends differ by, and a bump is the same at both.
        claims.add(name + ": error at 32 steps", fine, at_most(1e-2));
      } else {
        const bool left = rule.integrator == "left";
        claims.add(name + ": observed order", std::log2(coarse / fine),
                   left ? within(0.8, 1.25) : within(1.7, 2.5));
      }
    }
  }
}

void verify_exact_cases(const VerifySubjects& subjects, Claims& claims) {
  const double a = 1.3 / 64, size = kLength;
  const auto rising = make_table(
      size, max_table_entries, [&](double t) { return a * t; }, [](double) { return 1.0; });
  for (const CastRule& rule : all_cast_rules()) {
    if (rule.integrator == "left") continue;
    claims.add(rule.name() + ", P2 (κ = at, c = 1): exact",
               std::abs(shown(subjects, rising, rule, 1.0) + std::expm1(-a * size * size / 2)),
               at_most(3e-6));
  }
  const double jump = 0.1, at = 6.3, step = 0.5;
  const auto stepped = make_table(
      size, max_table_entries, [&](double t) { return t > at ? jump : 0.0; }, [](double) { return 1.0; });
  for (const CastRule& rule : all_cast_rules()) {
    const double error = std::abs(shown(subjects, stepped, rule, step) + std::expm1(-jump * (size - at)));
    claims.add(rule.name() + ", P8 (κ jumps): error / (K Δt)", error / (jump * step), at_most(1.0));
  }
  // A shell ten times thinner than a step, as opaque as a wall.
  const auto shell = make_table(
      size, max_table_entries, [](double t) { return t > 8.2 && t < 8.3 ? 200.0 : 0.0; },
      [](double) { return 1.0; });
  for (const char* form : {"table", "integral"}) {
    const CastRule rule{.integrator = "pre-integrated", .preintegration = form};
    claims.add(rule.name() + ", thin shell (κΔt = 200, a tenth of a step): opacity missed",
               std::abs(1 - shown(subjects, shell, rule, 1.0)), at_most(1e-3));
  }
}

}  // namespace

void verify_integrators(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures) {
  verify_orders(subjects, claims, figures);
  verify_exact_cases(subjects, claims);
}

}  // namespace brace
