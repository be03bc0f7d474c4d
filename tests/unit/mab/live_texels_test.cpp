#include "runtime/mab/live_texels.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace brace {
namespace {

constexpr int width = 37, height = 29;

std::vector<float> radial(double centre_x, double centre_y) {
  std::vector<float> x;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      x.push_back(static_cast<float>(
          std::min(1.0, std::hypot(column + 0.5 - centre_x, row + 0.5 - centre_y) / 30.0)));
  return x;
}

std::vector<AtlasRect> levels_of(const std::vector<double>& scales) {
  std::vector<AtlasRect> levels;
  for (const double scale : scales)
    levels.push_back({0, 0, std::max(1, static_cast<int>(std::lround(width * scale))),
                      std::max(1, static_cast<int>(std::lround(height * scale)))});
  return levels;
}

float share_at(const LevelWeights& weights, std::size_t level, float coordinate) {
  const float place = coordinate * 255.0f;
  const auto entry = std::min<std::size_t>(static_cast<std::size_t>(place), 254);
  const float* table = weights.entries.data() + level * mab_weight_entries;
  return table[entry] + (place - static_cast<float>(entry)) * (table[entry + 1] - table[entry]);
}

/// Numbers of the texels that the closing brace reads, as mab.glsl does.
std::set<std::size_t> texels_read(const std::vector<AtlasRect>& levels, const std::vector<float>& x,
                                  const LevelWeights& weights, int reach) {
  std::set<std::size_t> read;
  std::size_t first = 0;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const AtlasRect& size = levels[level];
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column) {
        if (!(share_at(weights, level, x[static_cast<std::size_t>(row * width + column)]) > 0.0f)) continue;
        const float u = (static_cast<float>(column) + 0.5f) * (static_cast<float>(size.width) / width) - 0.5f;
        const float v = (static_cast<float>(row) + 0.5f) * (static_cast<float>(size.height) / height) - 0.5f;
        for (int dy = 1 - reach; dy <= reach; ++dy)
          for (int dx = 1 - reach; dx <= reach; ++dx) {
            const float left = std::floor(u), top = std::floor(v);
            const bool no_share = reach == 1 && ((dx == 1 && u == left) || (dy == 1 && v == top));
            if (no_share) continue;
            const int tx = std::clamp(static_cast<int>(left) + dx, 0, size.width - 1);
            const int ty = std::clamp(static_cast<int>(top) + dy, 0, size.height - 1);
            read.insert(first + static_cast<std::size_t>(ty * size.width + tx));
          }
      }
    first += static_cast<std::size_t>(size.width * size.height);
  }
  return read;
}

struct Case {
  std::vector<double> scales;
  LevelAnchors anchors;
  double gaze_x, gaze_y;
};

std::vector<Case> cases() {
  return {
      {{1.0}, {1, {}, 0.05}, 18, 14},
      {{0.9, 0.7, 0.5, 0.3}, {4, {0, 0.3, 0.5, 0.7}, 0.05}, 18, 14},
      {{0.9, 0.7, 0.5, 0.3}, {4, {0, 0.3, 0.5, 0.7}, 0.05}, 0, 0},
      {{0.9, 0.7, 0.5, 0.3}, {4, {0, 0.1, 0.1, 0.2}, 0.3}, -40, 70},
      {{1.0, 0.5, 0.03, 0.01}, {4, {0, 0.2, 0.4, 0.6}, 0.1}, 30, 3},
      {{1.0, 0.9, 0.8, 0.6, 0.5, 0.3, 0.2, 0.1}, {8, {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}, 0.01}, 9, 20}};
}

TEST(LiveTexels, AreAllThatAnyPixelReadsAndFewMore) {
  for (const Case& c : cases())
    for (const int reach : {1, 2})
      for (const double t : {1.0, 0.8, 0.3, 0.0}) {
        const std::vector<AtlasRect> levels = levels_of(c.scales);
        const std::vector<float> x = radial(c.gaze_x, c.gaze_y);
        const LiveTexels texels(levels, {width, height, x}, reach);
        const LevelWeights weights = level_weights(moved(c.anchors, t));
        const std::set<std::size_t> read = texels_read(levels, x, weights, reach);
        const MabRays rays = texels.compact(weights);
        for (const std::size_t texel : read)
          ASSERT_NE(rays.ray_of_texel[texel], mab_none) << texel;
        ASSERT_EQ(rays.live, texels.count(weights));
        ASSERT_EQ(static_cast<std::uint64_t>(std::count_if(rays.ray_of_texel.begin(), rays.ray_of_texel.end(),
                                                           [](auto ray) { return ray != mab_none; })),
                  rays.live);
        // A ring around each level's part, at most.
        ASSERT_LE(rays.live, read.size() + 12 * c.scales.size() * (width + height) / 2);
      }
}

TEST(LiveTexels, OneFullLevelHasARayPerPixelAndNoOther) {
  const std::vector<AtlasRect> levels = levels_of({1.0});
  const std::vector<float> x = radial(18, 14);
  const LiveTexels texels(levels, {width, height, x}, 1);
  EXPECT_EQ(texels.count(level_weights({})), static_cast<std::uint64_t>(width * height));
}

TEST(LiveTexels, EveryRayOfTheListHasItsOwnTexelAndPaddingIsOneRowOfGroups) {
  for (const Case& c : cases()) {
    const std::vector<AtlasRect> levels = levels_of(c.scales);
    const std::vector<float> x = radial(c.gaze_x, c.gaze_y);
    const LiveTexels texels(levels, {width, height, x}, 1);
    const LevelWeights weights = level_weights(c.anchors);
    const Atlas atlas = pack_atlas(levels);
    for (const MabRays& rays : {texels.compact(weights), texels.discard(weights, atlas)}) {
      std::size_t first = 0;
      std::vector<std::size_t> firsts;
      for (const AtlasRect& level : levels) {
        firsts.push_back(first);
        first += static_cast<std::size_t>(level.width * level.height);
      }
      std::uint64_t live = 0;
      for (std::size_t ray = 0; ray < rays.texel_of_ray.size(); ++ray) {
        const std::uint32_t texel = rays.texel_of_ray[ray];
        if (texel == mab_none) continue;
        ++live;
        const std::size_t level = texel >> 28;
        const std::size_t at = firsts[level] +
                               (texel >> 14 & 0x3fffu) * static_cast<std::size_t>(levels[level].width) +
                               (texel & 0x3fffu);
        ASSERT_EQ(rays.ray_of_texel[at], ray);
      }
      ASSERT_EQ(live, rays.live);
    }
    const MabRays list = texels.compact(weights);
    ASSERT_EQ(list.across % 8, 0);
    ASSERT_LT(list.texel_of_ray.size(), list.live + 8 * static_cast<std::size_t>(list.across) + 64);
  }
}

}  // namespace
}  // namespace brace
