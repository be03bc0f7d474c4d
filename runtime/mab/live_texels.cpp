#include "runtime/mab/live_texels.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr int group = 8;  // rays across and down a work-group of the kernels

struct Extent {
  float low, high;
};

/// First and last of `pixels` whose reconstruction reads `texel` of `texels`: those with a centre less than
/// `reach` texels from the texel's; rounding outwards.
std::array<int, 2> readers(int texel, int texels, int pixels, int reach) {
  const double pixels_per_texel = static_cast<double>(pixels) / texels;
  const double first = (texel + 0.5 - reach) * pixels_per_texel - 0.5;
  const double last = (texel + 0.5 + reach) * pixels_per_texel - 0.5;
  return {std::clamp(static_cast<int>(std::floor(first)), 0, pixels - 1),
          std::clamp(static_cast<int>(std::ceil(last)), 0, pixels - 1)};
}

Extent joined(Extent a, Extent b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

int entry_below(float coordinate) {
  return static_cast<int>(coordinate * (mab_weight_entries - 1.0f));
}

}  // namespace

LiveTexels::LiveTexels(std::span<const AtlasRect> levels, const Picture& picture, int reach) {
  BRACE_CHECK(picture.coordinates.size() ==
              static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px));
  for (const AtlasRect& rect : levels) {
    Level& level = levels_.emplace_back();
    level.width = rect.width;
    level.height = rect.height;
    level.first = ranges_.size();
    measure(level, picture, reach);
  }
}

void LiveTexels::measure(Level& level, const Picture& picture, int reach) {
  // Across first: per picture row and texel column; then down.
  std::vector<Extent> rows(static_cast<std::size_t>(level.width) *
                           static_cast<std::size_t>(picture.height_px));
  for (int x = 0; x < level.width; ++x) {
    const auto [first, last] = readers(x, level.width, picture.width_px, reach);
    for (int row = 0; row < picture.height_px; ++row) {
      const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.width_px);
      const auto begin = picture.coordinates.begin() + static_cast<std::ptrdiff_t>(at) + first;
      const auto [low, high] = std::minmax_element(begin, begin + (last - first + 1));
      rows[static_cast<std::size_t>(row) * static_cast<std::size_t>(level.width) +
           static_cast<std::size_t>(x)] = {*low, *high};
    }
  }
  std::array<std::uint32_t, mab_weight_entries> lows{}, highs{};
  for (int y = 0; y < level.height; ++y) {
    const auto [first, last] = readers(y, level.height, picture.height_px, reach);
    for (int x = 0; x < level.width; ++x) {
      const auto cell = [&](int row) {
        return rows[static_cast<std::size_t>(row) * static_cast<std::size_t>(level.width) +
                    static_cast<std::size_t>(x)];
      };
      Extent extent = cell(first);
      for (int row = first + 1; row <= last; ++row)
        extent = joined(extent, cell(row));
      const Range range{static_cast<std::uint8_t>(entry_below(extent.low)),
                        static_cast<std::uint8_t>(std::min(entry_below(extent.high) + 1, 255))};
      ranges_.push_back(range);
      ++lows[range.low];
      ++highs[range.high];
    }
  }
  for (std::size_t e = mab_weight_entries - 1; e-- > 0;)
    level.low_above[e] = level.low_above[e + 1] + lows[e + 1];
  for (std::size_t e = 1; e < mab_weight_entries; ++e)
    level.high_below[e] = level.high_below[e - 1] + highs[e - 1];
}

std::uint64_t LiveTexels::count(const LevelWeights& weights) const {
  std::uint64_t live = 0;
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    const Level& level = levels_[i];
    const LevelWeights::Support& support = weights.support[i];
    if (support.first > support.last) continue;
    live += static_cast<std::uint64_t>(level.width) * static_cast<std::uint64_t>(level.height) -
            level.low_above[static_cast<std::size_t>(support.last)] -
            level.high_below[static_cast<std::size_t>(support.first)];
  }
  return live;
}

bool LiveTexels::is_live(const Level& level, std::size_t texel, const LevelWeights::Support& support) const {
  const Range range = ranges_[level.first + texel];
  return range.low <= support.last && range.high >= support.first;
}

template <class Visit>
void LiveTexels::visit_live(const LevelWeights& weights, const Visit& visit) const {
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    const Level& level = levels_[i];
    if (weights.support[i].first > weights.support[i].last) continue;
    for (int tile_y = 0; tile_y < level.height; tile_y += group)
      for (int tile_x = 0; tile_x < level.width; tile_x += group)
        for (int y = tile_y; y < std::min(tile_y + group, level.height); ++y)
          for (int x = tile_x; x < std::min(tile_x + group, level.width); ++x) {
            const auto texel = static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) +
                               static_cast<std::size_t>(x);
            if (is_live(level, texel, weights.support[i]))
              visit(static_cast<int>(i), x, y, level.first + texel);
          }
  }
}

MabRays LiveTexels::compact(const LevelWeights& weights) const {
  MabRays rays;
  rays.live = count(weights);
  const auto groups = static_cast<int>((rays.live + group * group - 1) / (group * group));
  const int across = std::max(1, static_cast<int>(std::ceil(std::sqrt(groups))));
  rays.across = across * group;
  rays.down = std::max(1, (groups + across - 1) / across) * group;
  rays.texel_of_ray.assign(static_cast<std::size_t>(rays.across) * static_cast<std::size_t>(rays.down),
                           mab_none);
  rays.ray_of_texel.assign(ranges_.size(), mab_none);
  int next = 0;
  visit_live(weights, [&](int level, int x, int y, std::size_t texel) {
    const int in_group = next % (group * group), at_group = next / (group * group);
    const int column = at_group % across * group + in_group % group;
    const int row = at_group / across * group + in_group / group;
    const auto ray = static_cast<std::uint32_t>(row * rays.across + column);
    rays.texel_of_ray[ray] = pack_texel(level, x, y);
    rays.ray_of_texel[texel] = ray;
    ++next;
  });
  return rays;
}

MabRays LiveTexels::discard(const LevelWeights& weights, const Atlas& atlas) const {
  MabRays rays;
  rays.across = atlas.width;
  rays.down = atlas.height;
  rays.texel_of_ray.assign(static_cast<std::size_t>(rays.across) * static_cast<std::size_t>(rays.down),
                           mab_none);
  rays.ray_of_texel.assign(ranges_.size(), mab_none);
  visit_live(weights, [&](int level, int x, int y, std::size_t texel) {
    const AtlasRect& rect = atlas.levels[static_cast<std::size_t>(level)];
    const auto ray = static_cast<std::uint32_t>((rect.y + y) * rays.across + rect.x + x);
    rays.texel_of_ray[ray] = pack_texel(level, x, y);
    rays.ray_of_texel[texel] = ray;
    ++rays.live;
  });
  return rays;
}

}  // namespace brace
