#include "runtime/mab/atlas.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr std::size_t permuted_max = 5;

/// Lowest free height over each column of the atlas: runs from x on.
struct Step {
  int x, y, width;
};

/// The lowest, then leftmost, place for a rectangle.
AtlasRect lowest_place(const std::vector<Step>& skyline, int atlas_width, AtlasRect rect) {
  AtlasRect best{0, -1, rect.width, rect.height};
  for (std::size_t i = 0; i < skyline.size() && skyline[i].x + rect.width <= atlas_width; ++i) {
    int y = 0;
    for (std::size_t j = i; j < skyline.size() && skyline[j].x < skyline[i].x + rect.width; ++j)
      y = std::max(y, skyline[j].y);
    if (best.y < 0 || y < best.y) best = {skyline[i].x, y, rect.width, rect.height};
  }
  return best;
}

void raise(std::vector<Step>& skyline, const AtlasRect& rect) {
  std::vector<Step> next;
  for (const Step& step : skyline) {
    const int end = step.x + step.width, rect_end = rect.x + rect.width;
    if (step.x < rect.x) next.push_back({step.x, step.y, std::min(end, rect.x) - step.x});
    if (step.x <= rect.x && rect.x < end) next.push_back({rect.x, rect.y + rect.height, rect.width});
    if (end > rect_end) {
      const int begin = std::max(step.x, rect_end);
      next.push_back({begin, step.y, end - begin});
    }
  }
  skyline = std::move(next);
}

Atlas pack(std::span<const AtlasRect> levels, std::span<const std::size_t> order, int width) {
  Atlas atlas{0, 0, std::vector<AtlasRect>(levels.size())};
  std::vector<Step> skyline = {{0, 0, width}};
  for (const std::size_t level : order) {
    const AtlasRect rect = lowest_place(skyline, width, levels[level]);
    BRACE_CHECK(rect.y >= 0);
    raise(skyline, rect);
    atlas.levels[level] = rect;
    atlas.width = std::max(atlas.width, rect.x + rect.width);
    atlas.height = std::max(atlas.height, rect.y + rect.height);
  }
  return atlas;
}

/// Sums of some of the widths, none below the widest.
std::set<int> widths_to_try(std::span<const AtlasRect> levels) {
  int widest = 0;
  for (const AtlasRect& level : levels)
    widest = std::max(widest, level.width);
  std::set<int> widths;
  for (std::uint32_t some = 1; some < 1u << levels.size(); ++some) {
    int sum = 0;
    for (std::size_t i = 0; i < levels.size(); ++i)
      if (some >> i & 1u) sum += levels[i].width;
    if (sum >= widest) widths.insert(sum);
  }
  return widths;
}

std::int64_t area(const Atlas& atlas) {
  return std::int64_t{atlas.width} * atlas.height;
}

}  // namespace

Atlas pack_atlas(std::span<const AtlasRect> levels) {
  BRACE_CHECK(!levels.empty() && levels.size() <= 16);
  std::vector<std::size_t> order(levels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto pixels = [&](std::size_t i) { return std::int64_t{levels[i].width} * levels[i].height; };
  const bool all_orders = levels.size() <= permuted_max;
  if (!all_orders)
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return pixels(a) > pixels(b); });

  Atlas best;
  do {
    for (const int width : widths_to_try(levels)) {
      Atlas atlas = pack(levels, order, width);
      if (best.levels.empty() || area(atlas) < area(best)) best = std::move(atlas);
    }
  } while (all_orders && std::next_permutation(order.begin(), order.end()));
  return best;
}

Atlas fixed_atlas(std::span<const AtlasRect> levels) {
  BRACE_CHECK(!levels.empty());
  Atlas atlas{levels[0].width, levels[0].height, {}};
  int y = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    AtlasRect rect = levels[i];
    rect.x = i == 0 ? 0 : levels[0].width;
    rect.y = i == 0 ? 0 : y;
    if (i > 0) y += rect.height;
    atlas.width = std::max(atlas.width, rect.x + rect.width);
    atlas.height = std::max(atlas.height, rect.y + rect.height);
    atlas.levels.push_back(rect);
  }
  return atlas;
}

}  // namespace brace
