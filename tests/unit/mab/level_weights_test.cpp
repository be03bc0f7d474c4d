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
  anchors.together = unit() < 0.5;
  for (int i = 1; i < levels; ++i)
    anchors.begin[static_cast<std::size_t>(i)] = unit();
  std::sort(anchors.begin.begin() + 1, anchors.begin.begin() + levels);
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
