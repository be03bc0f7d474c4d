#include "bench/tile_schedule.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

#include "base/error.hpp"

namespace brace {

namespace {

/// `area` counts tiles.
void split(const CastArea& area, std::vector<CastArea>& tiles) {
  if (area.width == 1 && area.height == 1) {
    tiles.push_back(area);
    return;
  }
  CastArea first = area, second = area;
  if (area.height < area.width) {
    first.width = area.width / 2;
    second.x += first.width;
    second.width -= first.width;
  } else {
    first.height = area.height / 2;
    second.y += first.height;
    second.height -= first.height;
  }
  split(first, tiles);
  split(second, tiles);
}

}  // namespace

std::vector<CastArea> split_tiles(int width_px, int height_px, int tile_px) {
  BRACE_CHECK(width_px > 0 && height_px > 0 && tile_px > 0);
  std::vector<CastArea> tiles;
  split({0, 0, (width_px + tile_px - 1) / tile_px, (height_px + tile_px - 1) / tile_px}, tiles);
  for (CastArea& tile : tiles) {
    tile.x *= tile_px;
    tile.y *= tile_px;
    tile.width = std::min(tile_px, width_px - tile.x);
    tile.height = std::min(tile_px, height_px - tile.y);
  }
  return tiles;
}

double makespan(std::span<const double> costs, int threads) {
  BRACE_CHECK(threads > 0);
  // A heap of the times at which threads become free, the earliest on top.
  std::vector<double> free_at(static_cast<std::size_t>(threads), 0.0);
  for (const double cost : costs) {
    std::pop_heap(free_at.begin(), free_at.end(), std::greater<>());
    free_at.back() += cost;
    std::push_heap(free_at.begin(), free_at.end(), std::greater<>());
  }
  return *std::max_element(free_at.begin(), free_at.end());
}

double speed_up(std::span<const double> costs, int threads) {
  const double longest = makespan(costs, threads);
  return longest > 0.0 ? std::accumulate(costs.begin(), costs.end(), 0.0) / longest : 1.0;
}

}  // namespace brace
