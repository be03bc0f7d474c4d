// Load controllers over load steps, against adversaries and at the ends of what can be measured.
#include <array>
#include <cmath>
#include <deque>
#include <numbers>

#include "runtime/verify/load_loop.hpp"
#include "runtime/verify/verify.hpp"

namespace brace {

namespace {

constexpr int kFrames = 3000;

/// Ends of what a renderer can report.
double outrageous(int frame) {
  constexpr std::array<double, 7> costs = {0.0, 1e300, 1e-300, 1.0, 1e12, 0.3, INFINITY};
  return costs[static_cast<std::size_t>(frame) % costs.size()];
}

void verify_stability_bound(const VerifySubjects& subjects, Claims& claims) {
  int wrong = 0;
  for (std::uint32_t delay = 0; delay <= 40; ++delay) {
    const double bound = 2.0 * std::sin(std::numbers::pi / (2.0 * (2.0 * delay + 1.0)));
    wrong += !subjects.pi_control_is_stable(0.0, 0.999 * bound, delay);
    wrong += subjects.pi_control_is_stable(0.0, 1.001 * bound, delay);
  }
  claims.add("integral gains a thousandth beside 2 sin(π / (2 (2 d + 1))), d = 0 … 40, misjudged", wrong,
             exactly(0));
  // The loop itself, simulated, on both sides of the bound.
  int disagree = 0;
  for (std::size_t delay = 0; delay <= 3; ++delay) {
    for (double gain = 0.05; gain < 2.2; gain += 0.1) {
      std::deque<double> u(delay + 1, 1.0);
      for (int k = 0; k < 20000 && std::abs(u.front()) < 1e6; ++k) {
        u.push_front(u.front() - gain * u[delay]);
        u.pop_back();
      }
      const double left = std::abs(u.front());
      if (left > 1e-3 && left < 1e3) continue;  // too near the bound to tell
      disagree +=
          subjects.pi_control_is_stable(0.0, gain, static_cast<std::uint32_t>(delay)) != (left <= 1e-3);
    }
  }
  claims.add("gains where the simulated loop and the criterion disagree", disagree, exactly(0));
}

/// The share that quantile tracking guarantees over N frames: p + (1 - p) (R + η) / (η N). It holds as long
/// as a frame one step above quality_min is on time; below, nothing is left to cut.
double quantile_guarantee(int frames) {
  constexpr double p = 0.01, step = 0.1;
  return p + (1.0 - p) * (-std::log(load_loop_quality_min) + step) / (step * frames);
}

void verify_quantile(const VerifySubjects& subjects, Claims& claims) {
  // Costs of an adversary that knows the quality: late whenever the guarantee lets a frame be late at all.
  const QualityUpdate update = subjects.quantile_control(false);
  double quality = 1.0;
  int missed = 0;
  for (int k = 0; k < kFrames; ++k) {
    const bool late = quality > load_loop_quality_min * std::exp(0.1);
    missed += late;
    quality = update({late ? 1.01 : 0.99, late});
  }
  claims.add("quantile rule against an adversary, missed share", static_cast<double>(missed) / kFrames,
             within(0.009, quantile_guarantee(kFrames)));
  const LoadLoop step = drive_load(subjects.quantile_control(true), tenfold_load_step, kFrames);
  claims.add("quantile rule with a proportional cut, 10× load step, missed share of 3000", step.missed_share,
             at_most(0.006));
  claims.add("its longest run of misses", step.longest_run, at_most(3), "frames");
  const LoadLoop steady = drive_load(
      subjects.quantile_control(true), [](int) { return 2.0; }, 20000);
  claims.add("quality it gives away at a steady load of 2, share of 1/2", 1.0 - 2.0 * steady.quality,
             within(-0.05, 0.15));
}

void verify_others(const VerifySubjects& subjects, Claims& claims) {
  const QualityUpdate pi = subjects.pi_control();
  drive_load(
      pi, [](int) { return 1e6; }, 5000);
  claims.add("PI: frames at an unbearable load pile nothing up; quality 20 frames later",
             drive_load(
                 pi, [](int) { return 0.5; }, 20)
                 .quality,
             exactly(1.0));
  claims.add("PI: cost that a steady load of 5 settles at, target 0.85",
             5.0 * drive_load(
                       subjects.pi_control(), [](int) { return 5.0; }, 500)
                       .quality,
             within(0.849, 0.851));
  const LoadLoop window = drive_load(subjects.window_control(), tenfold_load_step, kFrames);
  claims.add("window (Waschk): 10× load step, missed share of 3000", window.missed_share, at_most(0.05));
  claims.add("window: cost at a steady load of 2, within its thresholds",
             2.0 * drive_load(
                       subjects.window_control(), [](int) { return 2.0; }, 2000)
                       .quality,
             within(0.7, 0.95));
  double out_of_range = 0.0;
  for (const QualityUpdate& control : {subjects.pi_control(), subjects.quantile_control(true),
                                       subjects.quantile_control(false), subjects.window_control()})
    out_of_range += !drive_load(control, outrageous, 1000).in_range;
  claims.add("controllers that leave [quality_min, 1] at costs of 0, 1e-300, 1e300 and infinity",
             out_of_range, exactly(0));
}

}  // namespace

void verify_control(const VerifySubjects& subjects, Claims& claims, VerifyFigures&) {
  verify_stability_bound(subjects, claims);
  verify_quantile(subjects, claims);
  verify_others(subjects, claims);
}

}  // namespace brace
