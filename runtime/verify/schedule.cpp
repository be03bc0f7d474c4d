// The cell schedule over adversarial costs.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "runtime/verify/verify.hpp"

namespace brace {

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
