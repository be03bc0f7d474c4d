#include "runtime/frame/cell_cuts.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "runtime/frame/cell_schedule.hpp"

namespace brace {
namespace {

std::vector<double> random_costs(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> exponent(-3.0, 3.0);
  std::vector<double> costs;
  for (std::size_t i = 0; i < count; ++i)
    costs.push_back(std::pow(10.0, exponent(random)));
  return costs;
}

void expect_valid(const CellCuts& cuts) {
  double covered = 0.0;
  for (int cell = 0; cell < cuts.columns * cuts.rows; ++cell) {
    const CellCuts::Area area = cuts.area(cell);
    ASSERT_LE(area.left, area.right);
    ASSERT_LE(area.top, area.bottom);
    covered += (area.right - area.left) * (area.bottom - area.top);
  }
  EXPECT_NEAR(covered, 1.0, 1e-12);
  EXPECT_EQ(cuts.bands.front(), 0.0);
  EXPECT_EQ(cuts.bands.back(), 1.0);
}

TEST(CellCuts, EvenOnesAreAGrid) {
  const CellCuts cuts(4, 2);
  const CellCuts::Area area = cuts.area(6);
  EXPECT_EQ(area.left, 0.5);
  EXPECT_EQ(area.right, 0.75);
  EXPECT_EQ(area.top, 0.5);
  EXPECT_EQ(area.bottom, 1.0);
  expect_valid(cuts);
}

TEST(CellCuts, ByCostEveryCellTakesTheSame) {
  for (const auto& [columns, rows] : {std::pair(1, 1), {8, 8}, {3, 7}, {64, 2}}) {
    const CellCuts old(columns, rows);
    const std::vector<double> costs = random_costs(static_cast<std::size_t>(columns * rows), 5);
    CostDensity density(columns, rows);
    density.set(old, costs);
    CellCuts now(columns, rows);
    cut_by_cost(density, now);
    expect_valid(now);
    const double mean = std::accumulate(costs.begin(), costs.end(), 0.0) / (columns * rows);
    for (int cell = 0; cell < columns * rows; ++cell)
      EXPECT_NEAR(density.in(now.area(cell)), mean, 1e-4 * mean) << columns << " x " << rows << ", " << cell;
    // And again, from these cells, which differ in size.
    const std::vector<double> other = random_costs(costs.size(), 6);
    CostDensity again(columns, rows);
    again.set(now, other);
    CellCuts next(columns, rows);
    cut_by_cost(again, next);
    expect_valid(next);
    const double other_mean = std::accumulate(other.begin(), other.end(), 0.0) / (columns * rows);
    for (int cell = 0; cell < columns * rows; ++cell)
      EXPECT_NEAR(again.in(next.area(cell)), other_mean, 1e-3 * other_mean);
  }
}

TEST(CellCuts, NoCostIsLostWhereverItIsCut) {
  const std::vector<double> costs = random_costs(30, 9);
  CellCuts from(5, 6), to(5, 6);
  CostDensity density(5, 6);
  density.set(from, costs);
  cut_by_cost(density, to);
  double sum = 0.0;
  for (int cell = 0; cell < 30; ++cell)
    sum += density.in(to.area(cell));
  EXPECT_NEAR(sum, std::accumulate(costs.begin(), costs.end(), 0.0), 1e-9 * sum);
}

TEST(CellCuts, ExtremeCostsGiveValidCuts) {
  std::vector<std::vector<double>> extremes(5, std::vector<double>(16, 0.0));
  extremes[1][5] = 1.0;  // all in one cell
  extremes[2].assign(16, 1e300);
  extremes[3][0] = std::numeric_limits<double>::infinity();
  extremes[4][15] = 1e-300;
  for (const std::vector<double>& costs : extremes)
    for (const double even_share : {0.0, 0.1}) {
      CostDensity density(4, 4);
      density.set(CellCuts(4, 4), costs, even_share);
      CellCuts now(4, 4);
      cut_by_cost(density, now);
      expect_valid(now);
    }
}

TEST(CellSchedule, CutByCostCellsAreNearlyAlikeAndPredictedSo) {
  ChunkedParams params;
  params.columns = params.rows = 8;
  params.cut = ChunkedParams::Cut::cost;
  params.guard = ChunkedParams::Guard::prediction;
  CellSchedule schedule(params);
  // All of the work is in a corner of a ninth of the left eye's rays; the right eye's is even.
  const auto cost_of = [](int eye, const CellCuts::Area& area) {
    if (eye == 1) return 1e6 * (area.right - area.left) * (area.bottom - area.top);
    return 9e6 * std::max(std::min(area.right, 1.0 / 3) - area.left, 0.0) *
           std::max(std::min(area.bottom, 1.0 / 3) - area.top, 0.0);
  };
  double largest_even = 0.0, largest = 0.0;
  for (int frame = 0; frame < 8; ++frame) {
    schedule.begin_frame();
    largest = 0.0;
    while (schedule.left() > 0) {
      const CellSchedule::Cell cell = *schedule.next_in_any_case();
      const auto eye = static_cast<std::size_t>(cell.number / 64);
      const double ns = cost_of(static_cast<int>(eye), schedule.cuts()[eye].area(cell.number % 64));
      schedule.hand_out(cell);
      schedule.trace(cell, SimDuration(std::llround(ns)));
      largest = std::max(largest, ns);
    }
    if (frame == 0) largest_even = largest;
  }
  EXPECT_NEAR(largest_even, 9e6 / 64, 1.0);
  EXPECT_LT(largest, 1.5e6 / 64) << "a cell takes hardly more than the mean";
}

}  // namespace
}  // namespace brace
