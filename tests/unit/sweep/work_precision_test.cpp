#include "runtime/sweep/work_precision.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace brace {
namespace {

using testing::ElementsAre;

const double nothing = std::numeric_limits<double>::quiet_NaN();

TEST(ParetoFront, HasWhatNothingBeats) {
  EXPECT_THAT(pareto_front({{1, 9}, {2, 5}, {2, 6}, {3, 5}, {9, 1}}),
              ElementsAre(true, true, false, false, true));
  EXPECT_THAT(pareto_front({{1, 1}, {1, 1}}), ElementsAre(true, true)) << "equal ones do not beat each other";
  EXPECT_THAT(pareto_front({{5, 5}}), ElementsAre(true));
  EXPECT_TRUE(pareto_front({}).empty());
}

TEST(ParetoFront, LeavesOutPointsWithoutFigures) {
  EXPECT_THAT(pareto_front({{nothing, 0}, {1, nothing}, {2, 2}, {nothing, nothing}}),
              ElementsAre(false, false, true, false));
  EXPECT_THAT(pareto_front({{1, std::numeric_limits<double>::infinity()}, {2, 2}}), ElementsAre(true, true));
}

TEST(ParetoFront, NoPointOfItIsBeatenAndEveryOtherIs) {
  std::mt19937 random(8);
  for (int round = 0; round < 50; ++round) {
    std::vector<WorkErrorPoint> points;
    for (int i = 0; i < 40; ++i)
      points.push_back({static_cast<double>(random() % 12), static_cast<double>(random() % 12)});
    const std::vector<bool> front = pareto_front(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      bool beaten = false;
      for (const WorkErrorPoint& other : points) {
        const bool no_worse = other.work <= points[i].work && other.error <= points[i].error;
        const bool equal = other.work >= points[i].work && other.error >= points[i].error;
        beaten = beaten || (no_worse && !equal);
      }
      ASSERT_EQ(front[i], !beaten);
    }
  }
}

TEST(WorkToReach, IsTheLeastWorkOrNotReached) {
  const std::vector<WorkErrorPoint> points = {{5, 0.001}, {3, 0.01}, {1, 0.2}, {2, nothing}, {nothing, 0.0}};
  EXPECT_EQ(work_to_reach(points, 0.01), 3.0);
  EXPECT_EQ(work_to_reach(points, 0.5), 1.0);
  EXPECT_FALSE(work_to_reach(points, 1e-6).has_value());
  EXPECT_FALSE(work_to_reach({}, 1.0).has_value());
}

TEST(MedianOfPresent, IsTheMiddleOfWhatIsThere) {
  EXPECT_EQ(median_of_present({3.0, std::nullopt, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median_of_present({4.0, 1.0, nothing}), 2.5);
  EXPECT_TRUE(std::isnan(median_of_present({})));
  EXPECT_TRUE(std::isnan(median_of_present({std::nullopt})));
}

}  // namespace
}  // namespace brace
