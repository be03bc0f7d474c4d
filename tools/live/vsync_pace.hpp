#pragma once

#include <cstdint>
#include <optional>

#include "hmd_sim/vsync.hpp"

namespace brace {

/// When pictures are shown on a display that `brace live` imitates: at its vsyncs, whatever the desktop's own
/// are. Times are those of the live run.
class VsyncPace {
 public:
  explicit VsyncPace(sim::Rate rate) : clock_(SimTime(), rate) {}

  struct Slot {
    SimTime vsync{};
    std::int64_t missed = 0;  // vsyncs since the picture before that passed without a new one
  };
  /// The first vsync at or after `ready` that has no picture yet. The first picture misses none.
  Slot take(SimTime ready);

 private:
  sim::VsyncClock clock_;
  std::optional<std::int64_t> last_;
};

/// Vsyncs that passed between two pictures of a display whose own vsyncs are not known: those that the
/// interval is longer than one period by, to the nearest.
std::int64_t missed_in(SimDuration interval, sim::Rate rate);

/// Pictures per second as a fraction, to a thousandth of a hertz.
sim::Rate rate_of_hz(double hz);

}  // namespace brace
