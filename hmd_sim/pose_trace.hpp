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

/// Poses farther apart than this have a gap between them: nobody knows what the head did there.
inline constexpr SimDuration trace_gap = std::chrono::milliseconds(50);

/// Where an eye looks that is told nothing else: the head's -Z.
inline constexpr glm::dvec3 straight_ahead{0.0, 0.0, -1.0};

/// A recorded or generated head trace: times strictly increase, quaternions are unit and sign-continuous.
/// Gaps (intervals longer than 50 ms) are kept as invalid spans, never bridged.
class PoseTrace {
 public:
  /// At least two poses; throws input_error naming the trace and the pose if the invariant fails. Times are
  /// kept as given: a recording may start at any time, see shifted_to() in trace_info.hpp.
  /// `gaze`: none, or a reading for every pose, see gaze().
  PoseTrace(std::string name, std::vector<TimedPose> poses, std::vector<glm::dvec3> gaze = {});

  const std::string& name() const { return name_; }
  const std::vector<TimedPose>& poses() const { return poses_; }
  /// Where the eyes look at each pose: unit vectors in the head frame (straight ahead is -Z), NaN where the
  /// eye tracker has lost them (a blink). Empty: the trace has no gaze.
  const std::vector<glm::dvec3>& gaze() const { return gaze_; }
  bool has_gaze() const { return !gaze_.empty(); }
  SimTime begin_time() const { return poses_.front().time; }
  SimTime end_time() const { return poses_.back().time; }

  /// False outside the trace and inside a gap.
  bool valid_at(SimTime time) const;
  bool valid_at(SimTime time, std::size_t& hint) const;  // as at() with a hint

  /// The pose at a time, clamped to the ends; inside a gap the last pose before it (and valid_at is false).
  Pose at(SimTime time, Interpolation interpolation) const;

  /// The same; `hint` is an index kept by the caller that makes a forward walk amortised O(1).
  Pose at(SimTime time, Interpolation interpolation, std::size_t& hint) const;

  /// The gaze at a time, clamped to the ends, between neighbouring readings along the arc; a lost reading has
  /// the last valid one (straight ahead before the first), as has a gap. Straight ahead without gaze.
  glm::dvec3 gaze_at(SimTime time, std::size_t& hint) const;

  /// How the head moves at a pose, from the poses around it.
  struct Rates {
    glm::dvec3 angular_rad_s{0.0};  // head frame
    glm::dvec3 linear_m_s{0.0};     // world frame
  };

 private:
  Pose hermite_pose(std::size_t i, double s) const;
  void hold_gaze();

  std::string name_;
  std::vector<TimedPose> poses_;
  std::vector<Rates> rates_;                  // per pose, for Hermite
  std::vector<glm::dvec3> gaze_, held_gaze_;  // as read; with the last valid reading where one is lost
};

}  // namespace brace::sim
