#include "runtime/frame/cell_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"

namespace brace {

namespace {

/// Laid under what cells have taken before they are cut: none grows beyond about ten times the mean's area,
/// and where nothing was to be done before, something may be soon.
constexpr double kEvenShare = 0.1;

}  // namespace

CellSchedule::CellSchedule(const ChunkedParams& params)
    : params_(params),
      cuts_{CellCuts(params.columns, params.rows), CellCuts(params.columns, params.rows)},
      density_(params.columns, params.rows),
      costs_ns_(static_cast<std::size_t>(params.columns * params.rows)),
      traced_(2 * costs_ns_.size()),
      order_(traced_.size()),
      waiting_(traced_.size()) {
  BRACE_CHECK(params.columns > 0 && params.rows > 0 && params.bias >= 1.0);
  std::iota(order_.begin(), order_.end(), 0);
}

/// Squared distance of a cell's middle from that of its eye's picture.
double CellSchedule::off_axis(int cell) const {
  const int per_eye = params_.columns * params_.rows;
  const CellCuts::Area area = cuts_[static_cast<std::size_t>(cell / per_eye)].area(cell % per_eye);
  const double x = 0.5 * (area.left + area.right) - 0.5, y = 0.5 * (area.top + area.bottom) - 0.5;
  return x * x + y * y;
}

/// New cells, each with its part of what the old ones have taken.
void CellSchedule::cut() {
  const std::size_t per_eye = costs_ns_.size();
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const std::span<SimDuration> traced = std::span(traced_).subspan(eye * per_eye, per_eye);
    for (std::size_t i = 0; i < per_eye; ++i)
      costs_ns_[i] = static_cast<double>(traced[i].count());
    density_.set(cuts_[eye], costs_ns_, kEvenShare);
    const double sum_ns = std::accumulate(costs_ns_.begin(), costs_ns_.end(), 0.0);
    cut_by_cost(density_, cuts_[eye]);
    for (std::size_t i = 0; i < per_eye; ++i) {
      const CellCuts::Area area = cuts_[eye].area(static_cast<int>(i));
      const double even_ns = kEvenShare * sum_ns * (area.right - area.left) * (area.bottom - area.top);
      traced[i] = SimDuration(std::llround(std::clamp(density_.in(area)-even_ns, 0.0, 9e18)));
    }
  }
}

void CellSchedule::begin_frame() {
  std::fill(waiting_.begin(), waiting_.end(), true);
  left_ = cells();
  if (params_.cut == ChunkedParams::Cut::cost) cut();
  const auto by = [&](const auto& earlier) {
    std::sort(order_.begin(), order_.end(),
              [&](int a, int b) { return earlier(a) != earlier(b) ? earlier(a) < earlier(b) : a < b; });
  };
  if (params_.order == ChunkedParams::Order::cost)
    by([&](int cell) { return -traced_[static_cast<std::size_t>(cell)]; });
  if (params_.order == ChunkedParams::Order::gaze) by([&](int cell) { return off_axis(cell); });
}

SimDuration CellSchedule::from_neighbourhood(int cell) const {
  const int per_eye = params_.columns * params_.rows, in_eye = cell % per_eye, first = cell - in_eye;
  const int column = in_eye % params_.columns, row = in_eye / params_.columns;
  const SimDuration own = traced_[static_cast<std::size_t>(cell)];
  SimDuration sum{0};
  int count = 0;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, params_.rows - 1); ++y)
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, params_.columns - 1); ++x) {
      sum += std::max(own, traced_[static_cast<std::size_t>(first + y * params_.columns + x)]);
      ++count;
    }
  return sum / count;
}

CellSchedule::Cell CellSchedule::predict(int cell) const {
  const double ns = static_cast<double>(from_neighbourhood(cell).count()) * params_.bias * growth_;
  return {cell, SimDuration(std::llround(std::min(ns, 9e18)))};
}

std::optional<CellSchedule::Cell> CellSchedule::next(SimDuration budget) const {
  for (const int cell : order_) {
    if (!waiting_[static_cast<std::size_t>(cell)]) continue;
    const Cell candidate = predict(cell);
    if (candidate.predicted <= budget) return candidate;
    if (params_.order != ChunkedParams::Order::cost) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<CellSchedule::Cell> CellSchedule::next_in_any_case() const {
  std::optional<Cell> found;
  for (const int cell : order_) {
    if (!waiting_[static_cast<std::size_t>(cell)]) continue;
    found = predict(cell);
    if (params_.order != ChunkedParams::Order::cost) break;
  }
  return found;
}

void CellSchedule::hand_out(const Cell& cell) {
  BRACE_CHECK(waiting_[static_cast<std::size_t>(cell.number)]);
  waiting_[static_cast<std::size_t>(cell.number)] = false;
  --left_;
}

void CellSchedule::trace(const Cell& cell, SimDuration cost) {
  traced_[static_cast<std::size_t>(cell.number)] = cost;
  if (params_.guard != ChunkedParams::Guard::clock || cell.predicted <= SimDuration(0)) return;
  const double predicted = static_cast<double>(cell.predicted.count()) / (params_.bias * growth_);
  const double ratio = std::max(static_cast<double>(cost.count()) / std::max(predicted, 1.0), 1.0);
  growth_ = std::max(ratio, 0.5 * (growth_ + ratio));
}

}  // namespace brace
