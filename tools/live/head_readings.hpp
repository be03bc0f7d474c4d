#pragma once

#include <span>
#include <vector>

#include "base/pose.hpp"
#include "base/time.hpp"
#include "plugins/abi/brace_stage.h"

namespace brace {

/// What a tracker has told of the head in the window, for predict stages: its newest poses, as they truly
/// are.
class HeadReadings {
 public:
  static constexpr std::size_t kept = 4;
  static constexpr SimDuration spacing_min = std::chrono::milliseconds(4);

  /// A reading nearer than `spacing_min` to the one before the last takes the last one's place: neighbours
  /// among those kept are at least that far apart. Times do not fall.
  void add(SimTime time, const Pose& world_from_head);
  /// After a jump of the head: what was before it tells nothing.
  void forget() { readings_.clear(); }
  /// Oldest first. Velocities are the difference to the reading before, 0 of the first.
  std::span<const brace_tracker_sample> all() const { return readings_; }

 private:
  std::vector<brace_tracker_sample> readings_;
};

}  // namespace brace
