#include "runtime/mab/level_weights.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace brace {
namespace {

float share(const LevelWeights& weights, int level, int entry) {
  return weights.entries[static_cast<std::size_t>(level * mab_weight_entries + entry)];
}

LevelAnchors random_anchors(std::mt19937& random, int levels) {
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  LevelAnchors anchors;
  anchors.levels = levels;
  anchors.blend = 0.001 + unit() * unit();
  anchors.limited = unit() < 0.5;
  for (int i = 1; i < levels; ++i)
    anchors.begin[static_cast<std::size_t>(i)] = unit();
  std::sort(anchors.begin.begin() + 1, anchors.begin.begin() + levels);
  for (int i = 1; i < levels; ++i)
    anchors.limit[static_cast<std::size_t>(i)] = unit();
  std::sort(anchors.limit.begin() + 1, anchors.limit.begin() + levels);
  return anchors;
}

TEST(LevelWeights, AreSharesOfOneEverywhereAndSupportTellsWhere) {
  std::mt19937 random(2);
  for (int round = 0; round < 400; ++round) {
    const int levels = 1 + round % mab_levels_max;
    const double t = round % 5 == 0 ? 1.0 : static_cast<double>(random()) / 4294967296.0;
    const LevelWeights weights = level_weights(moved(random_anchors(random, levels), t));
    for (int entry = 0; entry < mab_weight_entries; ++entry) {
      double sum = 0.0;
      for (int level = 0; level < levels; ++level) {
        const float s = share(weights, level, entry);
        const LevelWeights::Support& support = weights.support[static_cast<std::size_t>(level)];
        ASSERT_GE(s, 0.0f);
        ASSERT_TRUE(s == 0.0f || (entry >= support.first && entry <= support.last));
        sum += static_cast<double>(s);
      }
      ASSERT_NEAR(sum, 1.0, 1e-6);
    }
  }
}

TEST(LevelWeights, RangesHoldEveryLevelWithAShareAndNoOtherAtTheirEnds) {
  std::mt19937 random(5);
  for (int round = 0; round < 100; ++round) {
    const int levels = 1 + round % mab_levels_max;
    const LevelWeights weights =
        level_weights(moved(random_anchors(random, levels), static_cast<double>(random()) / 4294967296.0));
    ASSERT_EQ(weights.ranges.size(), static_cast<std::size_t>(mab_weight_entries - 1));
    for (int entry = 0; entry + 1 < mab_weight_entries; ++entry) {
      const std::uint32_t range = weights.ranges[static_cast<std::size_t>(entry)];
      const auto first = static_cast<int>(range & 0xffu), last = static_cast<int>(range >> 8);
      const auto has_share = [&](int level) {
        return share(weights, level, entry) > 0.0f || share(weights, level, entry + 1) > 0.0f;
      };
      ASSERT_LE(first, last);
      ASSERT_TRUE(has_share(first) && has_share(last));
      for (int level = 0; level < levels; ++level)
        ASSERT_TRUE(!has_share(level) || (level >= first && level <= last));
    }
  }
}

TEST(LevelWeights, LimitsMoveAsTheRadialMapsAnchorsAndTakeNothingMore) {
  const LevelAnchors radial{4, {0, 0.3, 0.5, 0.7}, 0.05};
  LevelAnchors by_demand{4, {0, 0.4, 0.45, 1.0}, 0.05, true, {0, 0.3, 0.5, 0.7}};
  for (double t = 0.0; t <= 0.5; t += 0.05)
    for (std::size_t i = 1; i < 4; ++i)
      EXPECT_DOUBLE_EQ(moved(by_demand, t).begin[i],
                       std::min(by_demand.begin[i], moved(radial, 2 * t).begin[i]));
  EXPECT_DOUBLE_EQ(moved(by_demand, 0.75).begin[1], 0.4) << "half way from 0.3 to 1 is 0.65";
  EXPECT_DOUBLE_EQ(moved(by_demand, 0.75).begin[3], 0.85);
  EXPECT_EQ(moved(by_demand, 1.0).begin, by_demand.begin);
}

TEST(LevelWeights, OneLevelIsAllThereIs) {
  const LevelWeights weights = level_weights({});
  for (int entry = 0; entry < mab_weight_entries; ++entry)
    ASSERT_EQ(share(weights, 0, entry), 1.0f);
}

TEST(LevelWeights, FarMovedTheyLeaveOnlyTheCoarsestLevel) {
  std::mt19937 random(3);
  for (int levels = 1; levels <= mab_levels_max; ++levels) {
    const LevelWeights weights = level_weights(moved(random_anchors(random, levels), 0.0));
    for (int entry = 0; entry < mab_weight_entries; ++entry)
      ASSERT_EQ(share(weights, levels - 1, entry), 1.0f) << levels << " levels, entry " << entry;
  }
}

TEST(LevelWeights, FineAnchorsMoveFirst) {
  const LevelAnchors anchors{4, {0, 0.3, 0.5, 0.7}, 0.05};
  const LevelAnchors less = moved(anchors, 0.95);
  double before = 1.0;
  for (std::size_t i = 1; i < 4; ++i) {
    const double part = less.begin[i] / anchors.begin[i];
    EXPECT_LT(part, 1.0);
    if (i > 1) {
      EXPECT_GT(part, before);
    }
    before = part;
  }
}

/// A smooth step over the blend and nothing beside it: nowhere does a share change faster than 1.5 per blend.
TEST(LevelWeights, HaveNoSeam) {
  const LevelAnchors anchors{3, {0, 0.3, 0.6}, 0.1};
  const LevelWeights weights = level_weights(anchors);
  for (int level = 0; level < 3; ++level)
    for (int entry = 1; entry < mab_weight_entries; ++entry)
      ASSERT_LE(std::abs(share(weights, level, entry) - share(weights, level, entry - 1)),
                1.5 / (0.1 * 255) + 1e-6);
}

}  // namespace
}  // namespace brace
