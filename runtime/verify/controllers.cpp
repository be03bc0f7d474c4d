// Load controllers over load steps, and the cell schedule over adversarial costs.
#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <random>

#include "runtime/verify/verify.hpp"

namespace brace {

namespace {

using stages::FrameLoad;

constexpr int kFrames = 3000;
constexpr double kQualityMin = 0.05;

struct LoopResult {
  double missed_share = 0.0;
  int longest_run = 0;
  double quality = 1.0;  // at the end
  bool in_range = true;  // every quality within [quality_min, 1]
};

/// Frames that cost load(k) times the quality asked for `delay` frames before.
template <typename Load>
LoopResult drive(const QualityUpdate& update, const Load& load, int frames, std::size_t delay = 1) {
  std::deque<double> asked(delay + 1, 1.0);
  LoopResult result;
  int missed = 0, run = 0;
  for (int k = 0; k < frames; ++k) {
    const double cost = load(k) * asked.back();
    const bool late = !(cost <= 1.0);
    run = late ? run + 1 : 0;
    missed += late;
    result.longest_run = std::max(result.longest_run, run);
    result.quality = update({cost, late});
    result.in_range = result.in_range && result.quality >= kQualityMin * (1 - 1e-12) && result.quality <= 1.0;
    asked.push_front(result.quality);
    asked.pop_back();
  }
  result.missed_share = static_cast<double>(missed) / frames;
  return result;
}

double tenfold_step(int frame) {
  return frame < 1000 ? 0.5 : frame < 2000 ? 5.0 : 0.5;
}

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
  return p + (1.0 - p) * (-std::log(kQualityMin) + step) / (step * frames);
}

void verify_quantile(const VerifySubjects& subjects, Claims& claims) {
  // Costs of an adversary that knows the quality: late whenever the guarantee lets a frame be late at all.
  const QualityUpdate update = subjects.quantile_control(false);
  double quality = 1.0;
  int missed = 0;
  for (int k = 0; k < kFrames; ++k) {
    const bool late = quality > kQualityMin * std::exp(0.1);
    missed += late;
    quality = update({late ? 1.01 : 0.99, late});
  }
  claims.add("quantile rule against an adversary, missed share", static_cast<double>(missed) / kFrames,
             within(0.009, quantile_guarantee(kFrames)));
  const LoopResult step = drive(subjects.quantile_control(true), tenfold_step, kFrames);
  claims.add("quantile rule with a proportional cut, 10× load step, missed share of 3000", step.missed_share,
             at_most(0.006));
  claims.add("its longest run of misses", step.longest_run, at_most(3), "frames");
  const LoopResult steady = drive(
      subjects.quantile_control(true), [](int) { return 2.0; }, 20000);
  claims.add("quality it gives away at a steady load of 2, share of 1/2", 1.0 - 2.0 * steady.quality,
             within(-0.05, 0.15));
}

void verify_others(const VerifySubjects& subjects, Claims& claims) {
  const QualityUpdate pi = subjects.pi_control();
  drive(
      pi, [](int) { return 1e6; }, 5000);
  claims.add("PI: frames at an unbearable load pile nothing up; quality 20 frames later",
             drive(
                 pi, [](int) { return 0.5; }, 20)
                 .quality,
             exactly(1.0));
  claims.add("PI: cost that a steady load of 5 settles at, target 0.85",
             5.0 * drive(
                       subjects.pi_control(), [](int) { return 5.0; }, 500)
                       .quality,
             within(0.849, 0.851));
  const LoopResult window = drive(subjects.window_control(), tenfold_step, kFrames);
  claims.add("window (Waschk): 10× load step, missed share of 3000", window.missed_share, at_most(0.05));
  claims.add("window: cost at a steady load of 2, within its thresholds",
             2.0 * drive(
                       subjects.window_control(), [](int) { return 2.0; }, 2000)
                       .quality,
             within(0.7, 0.95));
  double out_of_range = 0.0;
  for (const QualityUpdate& control : {subjects.pi_control(), subjects.quantile_control(true),
                                       subjects.quantile_control(false), subjects.window_control()})
    out_of_range += !drive(control, outrageous, 1000).in_range;
  claims.add("controllers that leave [quality_min, 1] at costs of 0, 1e-300, 1e300 and infinity",
             out_of_range, exactly(0));
}

}  // namespace

void verify_control(const VerifySubjects& subjects, Claims& claims, VerifyFigures&) {
  verify_stability_bound(subjects, claims);
  verify_quantile(subjects, claims);
  verify_others(subjects, claims);
}

namespace {

/// What a guard by the clock does in one display period: cells while the next is predicted to fit.
struct Period {
  SimDuration spent{0};
  SimDuration last_over{0};  // the last cell's cost over its prediction
  int cells = 0;
};

template <typename Cost>
Period cast_in(const CellFunctions& schedule, SimDuration budget, const Cost& cost) {
  Period period;
  while (schedule.left() > 0) {
    const auto fits = schedule.next(budget - period.spent);
    const auto cell = fits ? fits : period.cells == 0 ? schedule.next_in_any_case() : std::nullopt;
    if (!cell) break;
    schedule.hand_out(*cell);
    const SimDuration took = cost(cell->number);
    schedule.trace(*cell, took);
    period.spent += took;
    period.last_over = took - cell->predicted;
    ++period.cells;
  }
  return period;
}

struct Overshoot {
  double beyond_rule = 0.0;  // periods over budget by more than the last cell's surprise
  double first_ms = 0.0;     // largest, of all periods
  double later_ms = 0.0;     // largest, of frames after that of a load step
  double cells_wrong = 0.0;  // frames whose cells are not each cast once
};

/// Frames with `factor(frame)` times a ninth of a millisecond per cell, the middle ones dearer.
template <typename Factor>
Overshoot cast_frames(const CellFunctions& schedule, int per_eye_edge, const Factor& factor, int step_frame) {
  constexpr SimDuration budget{10'000'000};
  Overshoot result;
  const int cells = 2 * per_eye_edge * per_eye_edge;
  for (int frame = 0; frame < 40; ++frame) {
    schedule.begin_frame();
    std::vector<int> casts(static_cast<std::size_t>(cells));
    for (int periods = 0; schedule.left() > 0 && periods < 10'000; ++periods) {
      const Period period = cast_in(schedule, budget, [&](int cell) {
        ++casts[static_cast<std::size_t>(cell)];
        return SimDuration(static_cast<std::int64_t>(factor(frame, cell) * 1e5));
      });
      const SimDuration over = period.spent - budget;
      if (period.cells > 1 && over > std::max(period.last_over, SimDuration(0))) ++result.beyond_rule;
      if (period.cells <= 1) continue;  // one cell is cast whatever it takes
      result.first_ms = std::max(result.first_ms, to_s(over) * 1e3);
      if (frame > step_frame) result.later_ms = std::max(result.later_ms, to_s(over) * 1e3);
    }
    result.cells_wrong += std::any_of(casts.begin(), casts.end(), [](int n) { return n != 1; });
  }
  return result;
}

double bell(int cell, int edge) {
  const double x = (cell % edge + 0.5) / edge - 0.5, y = (cell / edge % edge + 0.5) / edge - 0.5;
  return 0.2 + 3.0 * std::exp(-(x * x + y * y) / 0.05);
}

}  // namespace

void verify_schedule(const VerifySubjects& subjects, Claims& claims, VerifyFigures&) {
  constexpr int edge = 8, step_frame = 15;
  ChunkedParams params;
  params.columns = params.rows = edge;
  std::mt19937 random(3);
  const auto step = [&](int frame, int cell) {
    return bell(cell, edge) * (frame >= step_frame ? 10.0 : 1.0);
  };
  const auto flipping = [&](int frame, int cell) { return (frame + cell) % 2 == 0 ? 0.05 : 20.0; };
  const auto wild = [&](int, int) {
    return std::pow(10.0, -3.0 + 5.0 * static_cast<double>(random() >> 8) * 0x1p-24);
  };
  const auto nothing = [](int, int) { return 0.0; };
  Overshoot all;
  double first_of_step_ms = 0.0, later_of_step_ms = 0.0;
  for (const auto order :
       {ChunkedParams::Order::rows, ChunkedParams::Order::cost, ChunkedParams::Order::gaze}) {
    params.order = order;
    const auto add = [&](const Overshoot& one) {
      all.beyond_rule += one.beyond_rule;
      all.cells_wrong += one.cells_wrong;
    };
    const Overshoot stepped = cast_frames(subjects.cell_schedule(params), edge, step, step_frame);
    first_of_step_ms = std::max(first_of_step_ms, stepped.first_ms);
    later_of_step_ms = std::max(later_of_step_ms, stepped.later_ms);
    add(stepped);
    add(cast_frames(subjects.cell_schedule(params), edge, flipping, 0));
    add(cast_frames(subjects.cell_schedule(params), edge, wild, 0));
    add(cast_frames(subjects.cell_schedule(params), edge, nothing, 0));
  }
  claims.add(
      "frames whose cells are not each cast once: steps, flips, five decades at random, nothing; every order",
      all.cells_wrong, exactly(0));
  claims.add("periods over by more than the last cell's cost less its prediction", all.beyond_rule,
             exactly(0));
  claims.add("10× load step, periods of 10 ms: largest overshoot", first_of_step_ms, at_most(1.0), "ms");
  claims.add("the same from the next frame on", later_of_step_ms, at_most(0.1), "ms");
}

}  // namespace brace
