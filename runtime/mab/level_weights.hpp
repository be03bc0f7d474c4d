#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace brace {

inline constexpr int mab_levels_max = 8;
inline constexpr int mab_weight_entries = 256;

/// Where the levels of an atlas begin, over the coordinate x of level_map.hpp.
struct LevelAnchors {
  int levels = 1;                              // 1 … mab_levels_max
  std::array<double, mab_levels_max> begin{};  // of level i; [0] is not used; in rising order from 1 on
  double blend = 0.05;                         // width over which level i - 1 fades into level i
  bool limited = false;                        // how they move: see moved()
  std::array<double, mab_levels_max> limit{};  // as begin, of the radial map
};

/// The anchors with fewer rays: t = 1 leaves them, 0 gives everything to the coarsest level. In between those
/// of finer levels move first, begin' = (begin + blend) t^(levels - i) - blend (the paper moves one anchor by
/// the gradient of the frame times; this is the one-parameter family with the same order). With limits it is
/// those that move so, from t = 1/2 down, and none counts at t = 1: begin' = min(begin, limit'). A map that
/// knows where a scale is enough has then what the radial one has at the same t, without the rays that are of
/// no use.
LevelAnchors moved(const LevelAnchors& anchors, double t);

/// f_alpha: the share of every level at `mab_weight_entries` places x = e / 255, linear in between. Smooth
/// steps between neighbours; at every place the sum is 1.
struct LevelWeights {
  struct Support {  // entries with a share above 0; first > last: none
    int first = mab_weight_entries, last = -1;
  };
  int levels = 1;
  std::vector<float> entries;  // [level * mab_weight_entries + entry]
  std::array<Support, mab_levels_max> support{};
  /// Between entry e and e + 1: first | last << 8 of the levels with a share. A kernel visits these alone.
  std::vector<std::uint32_t> ranges;  // [mab_weight_entries - 1]
};
LevelWeights level_weights(const LevelAnchors& anchors);

}  // namespace brace
