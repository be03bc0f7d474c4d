#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/mab/atlas.hpp"
#include "runtime/mab/level_weights.hpp"

namespace brace {

/// No texel, no ray.
inline constexpr std::uint32_t mab_none = 0xffffffffu;

/// The rays of one eye: a grid of across * down rays, and which texel each belongs to.
struct MabRays {
  int across = 0, down = 0;
  std::uint64_t live = 0;                   // rays that belong to a texel
  std::vector<std::uint32_t> texel_of_ray;  // pack_texel, or mab_none
  std::vector<std::uint32_t> ray_of_texel;  // per texel, level after level, rows top to bottom
};

/// x, y of a texel in its level, below 2^14 each.
constexpr std::uint32_t pack_texel(int level, int x, int y) {
  return static_cast<std::uint32_t>(x) | static_cast<std::uint32_t>(y) << 14 |
         static_cast<std::uint32_t>(level) << 28;
}

/// Which texels of the levels any pixel reads, for whatever weights: each texel keeps the range of
/// coordinates of the pixels whose reconstruction reads it.
class LiveTexels {
 public:
  struct Picture {
    int width_px = 0, height_px = 0;
    std::span<const float> coordinates;  // of its pixels: level_coordinates
  };

  /// `reach`: texels on either side of a pixel that its reconstruction reads: 1 linear, 2 cubic.
  LiveTexels(std::span<const AtlasRect> levels, const Picture& picture, int reach);

  /// Live texels in O(levels).
  std::uint64_t count(const LevelWeights& weights) const;

  /// A ray for each live texel and no other, in groups of 8 x 8 rays whose texels lie together; only the
  /// last row of groups has rays without one.
  MabRays compact(const LevelWeights& weights) const;

  /// A ray for every texel of the atlas, those that no pixel reads without a texel (the paper's scheme).
  MabRays discard(const LevelWeights& weights, const Atlas& atlas) const;

 private:
  struct Range {
    std::uint8_t low, high;  // entries of the weight table
  };
  struct Level {
    int width = 0, height = 0;
    std::size_t first = 0;                                       // in ranges_
    std::array<std::uint32_t, mab_weight_entries> low_above{};   // texels with low > entry
    std::array<std::uint32_t, mab_weight_entries> high_below{};  // texels with high < entry
  };
  void measure(Level& level, const Picture& picture, int reach);
  bool is_live(const Level& level, std::size_t texel, const LevelWeights::Support& support) const;
  template <class Visit>
  void visit_live(const LevelWeights& weights, const Visit& visit) const;

  std::vector<Level> levels_;
  std::vector<Range> ranges_;
};

}  // namespace brace
