#include "runtime/mab/atlas.hpp"

#include <random>

#include <gtest/gtest.h>

namespace brace {
namespace {

long long area(const Atlas& atlas) {
  return 1LL * atlas.width * atlas.height;
}

void expect_packing(const Atlas& atlas, const std::vector<AtlasRect>& levels) {
  ASSERT_EQ(atlas.levels.size(), levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const AtlasRect& a = atlas.levels[i];
    EXPECT_EQ(a.width, levels[i].width);
    EXPECT_EQ(a.height, levels[i].height);
    EXPECT_TRUE(a.x >= 0 && a.y >= 0 && a.x + a.width <= atlas.width && a.y + a.height <= atlas.height);
    for (std::size_t j = 0; j < i; ++j) {
      const AtlasRect& b = atlas.levels[j];
      EXPECT_TRUE(a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y ||
                  b.y + b.height <= a.y)
          << "levels " << j << " and " << i << " overlap";
    }
  }
}

TEST(Atlas, OneLevelIsItself) {
  const Atlas atlas = pack_atlas(std::vector<AtlasRect>{{0, 0, 17, 9}});
  EXPECT_EQ(atlas.width, 17);
  EXPECT_EQ(atlas.height, 9);
}

TEST(Atlas, FindsAPerfectPackingWhereThereIsOne) {
  // Two squares beside a large one.
  const std::vector<AtlasRect> levels = {{0, 0, 100, 100}, {0, 0, 50, 50}, {0, 0, 50, 50}};
  EXPECT_EQ(area(pack_atlas(levels)), 15'000);
}

TEST(Atlas, NeverOverlapsAndIsNeverLargerThanAFixedArrangement) {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    std::vector<AtlasRect> levels;
    const int count = 1 + static_cast<int>(random() % 8);
    int width = 400, height = 300 + static_cast<int>(random() % 200);
    for (int i = 0; i < count; ++i) {
      levels.push_back({0, 0, std::max(1, width), std::max(1, height)});
      const double ratio = 0.1 + 0.85 * static_cast<double>(random()) / 4294967296.0;
      width = static_cast<int>(width * ratio);
      height = static_cast<int>(height * ratio);
    }
    const Atlas atlas = pack_atlas(levels);
    expect_packing(atlas, levels);
    expect_packing(fixed_atlas(levels), levels);
    EXPECT_LE(area(atlas), area(fixed_atlas(levels)));
  }
}

TEST(Atlas, ThePapersLevelsUseMoreOfItThanTheFixedArrangement) {
  std::vector<AtlasRect> levels;
  long long used = 0;
  for (const int percent : {90, 70, 50, 30}) {
    levels.push_back({0, 0, 1080 * percent / 100, 1200 * percent / 100});
    used += 1LL * levels.back().width * levels.back().height;
  }
  const double share = static_cast<double>(used) / static_cast<double>(area(pack_atlas(levels)));
  const double fixed = static_cast<double>(used) / static_cast<double>(area(fixed_atlas(levels)));
  EXPECT_GT(share, 0.85);
  EXPECT_GT(share, 1.1 * fixed);
}

}  // namespace
}  // namespace brace
