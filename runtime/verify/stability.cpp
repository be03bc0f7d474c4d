// Which κΔt from 1e-12 to 1e12 the rules survive, in single and half precision on the CPU and on the device.
#include <cmath>

#include "runtime/verify/verify.hpp"

namespace brace {

namespace {

constexpr int kFirst = -12, kLast = 12;

double stiffness(int exponent) {
  return std::pow(10.0, exponent);
}

void verify_on_cpu(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures) {
  for (const Precision precision : {Precision::fp32, Precision::fp16}) {
    const std::string name = precision == Precision::fp32 ? "fp32" : "fp16";
    for (const StabilityRule rule : {StabilityRule::euler, StabilityRule::thesis,
                                     StabilityRule::crank_nicolson, StabilityRule::exponential_left,
                                     StabilityRule::exponential_midpoint, StabilityRule::linear_source}) {
      StabilityRow row{to_string(rule), name, {}};
      int unbounded = 0, first_unbounded = kLast + 1;
      Largest error;
      for (int exponent = kFirst; exponent <= kLast; ++exponent) {
        const StabilityRun run = subjects.run_stability(rule, precision, stiffness(exponent));
        row.errors.push_back(run.bounded ? run.error : INFINITY);
        error.see(run.error);
        if (run.bounded) continue;
        ++unbounded;
        first_unbounded = std::min(first_unbounded, exponent);
      }
      figures.stability.push_back(row);
      const std::string claim = name + ", " + row.rule;
      if (rule == StabilityRule::euler) {
        claims.add(claim + ": leaves the bounds from κΔt = 10^", first_unbounded, exactly(1));
      } else if (rule == StabilityRule::thesis) {
        claims.add(claim + ": leaves the bounds from κΔt = 10^", first_unbounded, within(0, 1));
      } else if (rule == StabilityRule::crank_nicolson) {
        claims.add(claim + ": leaves the bounds from κΔt = 10^", first_unbounded, exactly(1));
      } else {
        claims.add(claim + ": out of bounds at", unbounded, exactly(0), "of 25");
        const double rounding = precision == Precision::fp32 ? 2e-6 : 5e-3;
        claims.add(claim + ": largest error", error.value(),
                   at_most(rule == StabilityRule::linear_source ? rounding : 0.02 + rounding));
      }
    }
  }
}

/// Rays of one value each; a plateau of the table per stiffness.
void verify_on_device(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures) {
  constexpr int rays = kLast - kFirst + 1, per_value = 170, length = 16;
  static const Volume volume = make_volume({length + 1, rays, 2}, [](int, int y, int) { return y; });
  std::vector<CastRule> rules = all_cast_rules();
  rules.push_back({.integrator = "linear-source", .tolerance = 1e-3});
  rules.push_back({.integrator = "pre-integrated", .preintegration = "integral", .tolerance = 1e-3});
  const double step = CastRule{}.step_voxels;
  const auto table = make_table(
      rays - 1, per_value * (rays - 1) + 1,
      [&](double v) { return stiffness(kFirst + static_cast<int>(std::lround(v))) / step; },
      [](double) { return 0.75; });
  std::vector<CastRay> along, across;
  for (int i = 0; i < rays; ++i) {
    along.push_back({{0.5f, static_cast<float>(i) + 0.5f, 1.0f, float(length)}, {1, 0, 0, 0}});
    // Through all of them, forwards and backwards.
    const bool up = i % 2 == 0;
    const float x = 0.5f + 0.5f * static_cast<float>(i);
    across.push_back({{x, up ? 0.5f : static_cast<float>(rays) - 0.5f, 1.0f, float(rays - 1)},
                      {0, up ? 1.0f : -1.0f, 0, 0}});
  }
  for (const CastRule& rule : rules) {
    StabilityRow row{"cast/dvr " + rule.name(), "device", {}};
    const auto colours = subjects.cast({&volume, table, along, rule, SkipKind::none}).colours;
    int unbounded = 0;
    Largest error;
    const auto is_bounded = [](const glm::vec4& c) {
      return c.a >= 0 && c.a <= 1 && c.r >= 0 && c.r <= 0.75f * c.a + 1e-6f;
    };
    for (int i = 0; i < rays; ++i) {
      const glm::vec4& c = colours[static_cast<std::size_t>(i)];
      const double exact = -std::expm1(-stiffness(kFirst + i) * length / step);
      const double off = std::max(std::abs(c.a - exact), std::abs(c.r - 0.75 * exact));
      error.see(off);
      unbounded += !is_bounded(c);
      row.errors.push_back(is_bounded(c) ? off : INFINITY);
    }
    figures.stability.push_back(row);
    for (const glm::vec4& c : subjects.cast({&volume, table, across, rule, SkipKind::none}).colours)
      unbounded += !is_bounded(c);
    claims.add("device, " + rule.name() + ": rays out of bounds", unbounded, exactly(0), "of 50");
    claims.add("device, " + rule.name() + ": largest error in a slab", error.value(), at_most(1e-5));
  }
}

}  // namespace

void verify_stability(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures) {
  verify_on_cpu(subjects, claims, figures);
  verify_on_device(subjects, claims, figures);
}

}  // namespace brace
