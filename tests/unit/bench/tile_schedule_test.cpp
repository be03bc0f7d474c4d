#include "bench/tile_schedule.hpp"

#include <vector>

#include <gtest/gtest.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

namespace brace {
namespace {

TEST(TileSchedule, WithoutTilesNothingTakesTime) {
  EXPECT_EQ(makespan({}, 1), 0.0);
  EXPECT_EQ(makespan({}, 64), 0.0);
  EXPECT_EQ(speed_up({}, 64), 1.0);
}

TEST(TileSchedule, OneTileIsNotSharedOut) {
  const std::vector<double> one = {7.0};
  for (const int threads : {1, 2, 64}) {
    EXPECT_EQ(makespan(one, threads), 7.0);
    EXPECT_EQ(speed_up(one, threads), 1.0);
  }
}

TEST(TileSchedule, MoreThreadsThanTilesTakeAsLongAsTheLongestTile) {
  const std::vector<double> costs = {3.0, 5.0, 2.0};
  EXPECT_EQ(makespan(costs, 3), 5.0);
  EXPECT_EQ(makespan(costs, 64), 5.0);
  EXPECT_EQ(speed_up(costs, 64), 2.0);
}

TEST(TileSchedule, EqualTilesTakeWholeRounds) {
  const std::vector<double> costs(10, 2.0);
  EXPECT_EQ(makespan(costs, 1), 20.0);
  EXPECT_EQ(makespan(costs, 2), 10.0);
  EXPECT_EQ(makespan(costs, 4), 6.0);
  EXPECT_EQ(makespan(costs, 10), 2.0);
}

TEST(TileSchedule, AFreeThreadTakesTheNextTile) {
  // Thread A: 4, then 1 as B is busy until 5; thread B: 5. Then 6 goes to whoever is first: A or B at 5.
  const std::vector<double> costs = {4.0, 5.0, 1.0, 6.0};
  EXPECT_EQ(makespan(costs, 2), 11.0);
}

TEST(TileSchedule, EmptyTilesCostNothing) {
  const std::vector<double> costs = {0.0, 0.0, 8.0, 0.0, 8.0};
  EXPECT_EQ(makespan(costs, 2), 8.0);
  EXPECT_EQ(speed_up(std::vector<double>(5, 0.0), 2), 1.0);
}

TEST(TileSchedule, TilesAreInTheOrderOfTbb) {
  using Range = tbb::blocked_range2d<int>;
  const int pictures[][2] = {{512, 512}, {1080, 1200}, {1, 1}, {33, 20}, {700, 31}};
  for (const auto& [width, height] : pictures) {
    std::vector<CastArea> theirs;
    tbb::task_arena arena(1);
    arena.execute([&, width = width, height = height] {
      tbb::parallel_for(
          Range(0, (height + 31) / 32, 1, 0, (width + 31) / 32, 1),
          [&](const Range& tile) {
            theirs.push_back({tile.cols().begin() * 32, tile.rows().begin() * 32});
          },
          tbb::simple_partitioner());
    });
    const std::vector<CastArea> ours = split_tiles(width, height, 32);
    ASSERT_EQ(ours.size(), theirs.size()) << width << " x " << height;
    int pixels = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      EXPECT_EQ(ours[i].x, theirs[i].x) << i;
      EXPECT_EQ(ours[i].y, theirs[i].y) << i;
      pixels += ours[i].width * ours[i].height;
    }
    EXPECT_EQ(pixels, width * height);
  }
}

}  // namespace
}  // namespace brace
