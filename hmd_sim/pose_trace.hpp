#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "base/pose.hpp"
#include "base/time.hpp"

namespace brace::sim {

struct TimedPose {
  SimTime time;
  Pose world_from_head;
};

enum class Interpolation {
  slerp_linear,  // observed order 2
  hermite        // log-chart Hermite with mapped end rates, observed order 4
};

/// A recorded or generated head trace: times strictly increase, quaternions are unit and sign-continuous.
/// Gaps (intervals longer than 50 ms) are kept as invalid spans, never bridged.
class PoseTrace {
 public:
  PoseTrace(std::string name, std::vector<TimedPose> poses);  // throws brace::Error if the invariant fails

  const std::string& name() const { return name_; }
  const std::vector<TimedPose>& poses() const { return poses_; }
  SimTime begin_time() const { return poses_.front().time; }
  SimTime end_time() const { return poses_.back().time; }

  /// False outside the trace and inside a gap.
  bool valid_at(SimTime time) const;

  /// The pose at a time, clamped to the ends; inside a gap the last pose before it (and valid_at is false).
  Pose at(SimTime time, Interpolation interpolation) const;

  /// The same; `hint` is an index kept by the caller that makes a forward walk amortised O(1).
  Pose at(SimTime time, Interpolation interpolation, std::size_t& hint) const;

 private:
  std::string name_;
  std::vector<TimedPose> poses_;
};

}  // namespace brace::sim
