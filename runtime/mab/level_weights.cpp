#include "runtime/mab/level_weights.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace brace {

namespace {

/// 0 up to `begin`, 1 from begin + width on.
double smooth_step(double begin, double width, double x) {
  if (!(x > begin)) return 0.0;
  if (x >= begin + width) return 1.0;
  const double t = (x - begin) / width;
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

LevelAnchors moved(const LevelAnchors& anchors, double t) {
  LevelAnchors result = anchors;
  const double last = anchors.begin[static_cast<std::size_t>(anchors.levels - 1)];
  for (int i = 1; i < anchors.levels; ++i) {
    double& begin = result.begin[static_cast<std::size_t>(i)];
    if (anchors.together) {
      begin -= (1.0 - t) * (last + anchors.blend);
    } else {
      begin = (begin + anchors.blend) * std::pow(t, anchors.levels - i) - anchors.blend;
    }
  }
  return result;
}

LevelWeights level_weights(const LevelAnchors& anchors) {
  BRACE_CHECK(anchors.levels >= 1 && anchors.levels <= mab_levels_max);
  LevelWeights weights;
  weights.levels = anchors.levels;
  weights.entries.resize(static_cast<std::size_t>(anchors.levels * mab_weight_entries));
  for (int entry = 0; entry < mab_weight_entries; ++entry) {
    const double x = entry / (mab_weight_entries - 1.0);
    // Of level i and all coarser ones; rounded once, so that the shares' sum telescopes to 1.
    float from_here = 1.0f;
    for (int level = 0; level < anchors.levels; ++level) {
      const auto next = static_cast<std::size_t>(level + 1);
      float coarser = 0.0f;
      if (level + 1 < anchors.levels)
        coarser = std::min(static_cast<float>(smooth_step(anchors.begin[next], anchors.blend, x)), from_here);
      const float share = from_here - coarser;
      weights.entries[static_cast<std::size_t>(level * mab_weight_entries + entry)] = share;
      if (share > 0.0f) {
        LevelWeights::Support& support = weights.support[static_cast<std::size_t>(level)];
        support.first = std::min(support.first, entry);
        support.last = entry;
      }
      from_here = coarser;
    }
  }
  return weights;
}

}  // namespace brace
