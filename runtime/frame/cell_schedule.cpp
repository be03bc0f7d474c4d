#include "runtime/frame/cell_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"

namespace brace {

namespace {

/// Squared distance of a cell from the middle of its eye's picture.
double off_axis(const ChunkedParams& params, int cell) {
  const int in_eye = cell % (params.columns * params.rows);
  const double x = (in_eye % params.columns + 0.5) / params.columns - 0.5;
  const double y = (in_eye / params.columns + 0.5) / params.rows - 0.5;
  return x * x + y * y;
}

}  // namespace

CellSchedule::CellSchedule(const ChunkedParams& params)
    : params_(params),
      traced_(static_cast<std::size_t>(2 * params.columns * params.rows)),
      order_(traced_.size()),
      waiting_(traced_.size()) {
  BRACE_CHECK(params.columns > 0 && params.rows > 0 && params.bias >= 1.0);
  std::iota(order_.begin(), order_.end(), 0);
  if (params.order == ChunkedParams::Order::gaze) {
    std::stable_sort(order_.begin(), order_.end(),
                     [&](int a, int b) { return off_axis(params, a) < off_axis(params, b); });
  }
}

void CellSchedule::begin_frame() {
  std::fill(waiting_.begin(), waiting_.end(), true);
  left_ = cells();
  if (params_.order != ChunkedParams::Order::cost) return;
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    const SimDuration of_a = traced_[static_cast<std::size_t>(a)],
                      of_b = traced_[static_cast<std::size_t>(b)];
    return of_a != of_b ? of_a > of_b : a < b;
  });
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
