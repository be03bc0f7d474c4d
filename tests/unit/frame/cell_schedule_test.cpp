#include "runtime/frame/cell_schedule.hpp"

#include <random>
#include <set>

#include <gtest/gtest.h>

namespace brace {
namespace {

constexpr SimDuration forever = SimDuration::max();

ChunkedParams grid(int columns, int rows) {
  ChunkedParams params;
  params.columns = columns;
  params.rows = rows;
  params.guard = ChunkedParams::Guard::prediction;
  return params;
}

/// Casts a frame whose cells take `costs`.
std::vector<int> cast(CellSchedule& schedule, const std::vector<std::int64_t>& costs) {
  std::vector<int> order;
  schedule.begin_frame();
  while (schedule.left() > 0) {
    const CellSchedule::Cell cell = *schedule.next_in_any_case();
    schedule.hand_out(cell);
    schedule.trace(cell, SimDuration(costs[static_cast<std::size_t>(cell.number)]));
    order.push_back(cell.number);
  }
  EXPECT_FALSE(schedule.next(forever).has_value());
  return order;
}

TEST(CellSchedule, PredictsTheBiasedMeanOfMaximaOverTheNeighbourhood) {
  ChunkedParams params = grid(3, 2);
  params.bias = 2.0;
  CellSchedule schedule(params);
  // Left eye 10 20 30 / 40 50 60, right eye ten times as much.
  (void)cast(schedule, {10, 20, 30, 40, 50, 60, 100, 200, 300, 400, 500, 600});
  schedule.begin_frame();
  // Cell 0 with itself, 1, 3 and 4: 10, 20, 40, 50.
  EXPECT_EQ(schedule.next(forever)->predicted, SimDuration(2 * (10 + 20 + 40 + 50) / 4));
  schedule.hand_out(*schedule.next(forever));
  // Cell 1 has all six of its eye; those below 20 count as 20.
  EXPECT_EQ(schedule.next(forever)->predicted, SimDuration(2 * ((20 + 20 + 30 + 40 + 50 + 60) / 6)));
}

TEST(CellSchedule, HandsOutEveryCellOnceInEveryOrder) {
  std::mt19937 random(4);
  for (const auto order :
       {ChunkedParams::Order::rows, ChunkedParams::Order::cost, ChunkedParams::Order::gaze})
    for (const auto& [columns, rows] : {std::pair(1, 1), {5, 3}, {16, 16}}) {
      ChunkedParams params = grid(columns, rows);
      params.order = order;
      CellSchedule schedule(params);
      for (int frame = 0; frame < 4; ++frame) {
        std::vector<std::int64_t> costs;
        for (int i = 0; i < schedule.cells(); ++i)
          costs.push_back(static_cast<std::int64_t>(random() % 1'000'000));
        const std::vector<int> cells = cast(schedule, costs);
        EXPECT_EQ(std::set<int>(cells.begin(), cells.end()).size(),
                  static_cast<std::size_t>(2 * columns * rows));
      }
    }
}

TEST(CellSchedule, OrdersByCostTakeTheDearestThatFitsAndByGazeTheMiddleFirst) {
  ChunkedParams params = grid(3, 1);
  params.order = ChunkedParams::Order::cost;
  CellSchedule by_cost(params);
  (void)cast(by_cost, {900, 10, 10, 10, 10, 300});
  by_cost.begin_frame();
  EXPECT_EQ(by_cost.next(forever)->number, 0);
  EXPECT_EQ(by_cost.next(SimDuration(400))->number, 5) << "the dearest does not fit";
  EXPECT_FALSE(by_cost.next(SimDuration(5)).has_value());

  params = grid(3, 3);
  params.order = ChunkedParams::Order::gaze;
  CellSchedule by_gaze(params);
  const std::vector<int> order = cast(by_gaze, std::vector<std::int64_t>(18, 1));
  EXPECT_EQ(order[0], 4);
  EXPECT_EQ(order[1], 13) << "the right eye's";
}

TEST(CellSchedule, BehindTheClockARiseOfTheLoadIsKnownAfterOneCell) {
  ChunkedParams params = grid(4, 4);
  params.guard = ChunkedParams::Guard::clock;
  CellSchedule schedule(params);
  for (int frame = 0; frame < 2; ++frame)
    (void)cast(schedule, std::vector<std::int64_t>(32, 1000));
  schedule.begin_frame();
  CellSchedule::Cell cell = *schedule.next(forever);
  EXPECT_NEAR(static_cast<double>(cell.predicted.count()), 1000.0, 1.0);
  schedule.hand_out(cell);
  schedule.trace(cell, SimDuration(10'000));
  cell = *schedule.next(forever);
  EXPECT_GE(cell.predicted, SimDuration(9'990)) << "tenfold for all that are left";
}

TEST(CellSchedule, ExtremeTimesStayNumbers) {
  ChunkedParams params = grid(2, 2);
  params.guard = ChunkedParams::Guard::clock;
  CellSchedule schedule(params);
  for (const std::int64_t ns : {std::int64_t{0}, std::int64_t{1}, std::int64_t{1'000'000'000'000'000},
                                std::int64_t{0}, std::int64_t{5}}) {
    (void)cast(schedule, std::vector<std::int64_t>(8, ns));
    schedule.begin_frame();
    EXPECT_GE(schedule.next(forever)->predicted, SimDuration(0));
    (void)cast(schedule, std::vector<std::int64_t>(8, ns));
  }
}

}  // namespace
}  // namespace brace
