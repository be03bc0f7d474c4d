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

std::vector<std::uint32_t> ranges_of(const LevelWeights& weights) {
  std::vector<std::uint32_t> ranges;
  for (int entry = 0; entry + 1 < mab_weight_entries; ++entry) {
    std::uint32_t first = mab_levels_max, last = 0;
    for (int level = 0; level < weights.levels; ++level) {
      const auto at = static_cast<std::size_t>(level * mab_weight_entries + entry);
      if (!(weights.entries[at] > 0.0f) && !(weights.entries[at + 1] > 0.0f)) continue;
      first = std::min(first, static_cast<std::uint32_t>(level));
      last = static_cast<std::uint32_t>(level);
    }
    ranges.push_back(first | last << 8);
  }
  return ranges;
}

}  // namespace

LevelAnchors moved(const LevelAnchors& anchors, double t) {
  LevelAnchors result = anchors;
  const auto fewer = [&](double begin, int level, double s) {
    return (begin + anchors.blend) * std::pow(s, anchors.levels - level) - anchors.blend;
  };
  for (int i = 1; i < anchors.levels; ++i) {
    const auto level = static_cast<std::size_t>(i);
    const double limit = anchors.limit[level];
    if (!anchors.limited) {
      result.begin[level] = fewer(anchors.begin[level], i, t);
    } else if (t < 0.5) {
      result.begin[level] = std::min(anchors.begin[level], fewer(limit, i, 2.0 * t));
    } else {
      result.begin[level] = std::min(anchors.begin[level], limit + (1.0 - limit) * (2.0 * t - 1.0));
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
  weights.ranges = ranges_of(weights);
  return weights;
}

}  // namespace brace
