#pragma once

#include <array>
#include <vector>

namespace brace {

inline constexpr int mab_levels_max = 8;
inline constexpr int mab_weight_entries = 256;

/// Where the levels of an atlas begin, over the coordinate x of level_map.hpp.
struct LevelAnchors {
  int levels = 1;                              // 1 … mab_levels_max
  std::array<double, mab_levels_max> begin{};  // of level i; [0] is not used; in rising order from 1 on
  double blend = 0.05;                         // width over which level i - 1 fades into level i
  bool together = false;                       // how they move
};

/// The anchors with fewer rays: t = 1 leaves them, 0 gives everything to the coarsest level. In between
/// either those of finer levels move first, begin' = (begin + blend) t^(levels - i) - blend (the paper moves
/// one anchor by the gradient of the frame times; this is the one-parameter family with the same order), or
/// all move together, which over the logarithm of a demand asks for the same share of it everywhere.
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
};
LevelWeights level_weights(const LevelAnchors& anchors);

}  // namespace brace
