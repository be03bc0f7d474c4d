#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>

#include "stages/control/load_control.hpp"

namespace brace {

// A load controller in its loop, without a renderer: what its claims and its tests drive.

inline constexpr double load_loop_quality_min = 0.05;  // the controllers' default

struct LoadLoop {
  double missed_share = 0.0;
  int longest_run = 0;   // of misses
  double quality = 1.0;  // at the end
  bool in_range = true;  // every quality within [load_loop_quality_min, 1]
};

/// Frames that cost load(k) times the quality asked for `delay` frames before; 1 is the budget.
/// `update` takes a stages::FrameLoad and gives the quality of a later frame.
template <typename Update, typename Load>
LoadLoop drive_load(const Update& update, const Load& load, int frames, std::size_t delay = 1) {
  std::deque<double> asked(delay + 1, 1.0);
  LoadLoop loop;
  int missed = 0, run = 0;
  for (int k = 0; k < frames; ++k) {
    const double cost = load(k) * asked.back();
    const bool late = !(cost <= 1.0);
    run = late ? run + 1 : 0;
    missed += late;
    loop.longest_run = std::max(loop.longest_run, run);
    loop.quality = update(stages::FrameLoad{cost, late});
    loop.in_range =
        loop.in_range && loop.quality >= load_loop_quality_min * (1 - 1e-12) && loop.quality <= 1.0;
    asked.push_front(loop.quality);
    asked.pop_back();
  }
  loop.missed_share = static_cast<double>(missed) / frames;
  return loop;
}

/// Half the budget, five times it for a thousand frames, and half again.
inline double tenfold_load_step(int frame) {
  return frame < 1000 ? 0.5 : frame < 2000 ? 5.0 : 0.5;
}

}  // namespace brace
