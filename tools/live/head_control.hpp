#pragma once

#include <functional>
#include <vector>

#include "hmd_sim/pose_trace.hpp"

namespace brace {

/// What mouse and keys ask of the head, since the last time.
struct HeadInput {
  double turn_right_rad = 0.0, turn_up_rad = 0.0;  // by this much
  double right = 0.0, up = 0.0, forward = 0.0;     // -1, 0 or 1: while a key is held
};

/// A head turned about its neck and moved by hand.
class HeadControl {
 public:
  static constexpr double speed_m_s = 0.5;
  static constexpr double pitch_rad_max = 1.4;

  /// Goes on from a pose; its roll is lost.
  void start_from(const Pose& world_from_head);
  void advance(const HeadInput& input, double seconds);
  Pose pose() const;

 private:
  glm::dquat rotation() const;

  double yaw_rad_ = 0.0, pitch_rad_ = 0.0;
  glm::dvec3 eyes_at_rest_m_{0.0};
};

/// Poses with their times, to become a trace.
class HeadRecording {
 public:
  /// As trackers sample. Whatever the pictures' rate, a trace has no gaps and what lies between them.
  static constexpr SimDuration spacing_max = std::chrono::milliseconds(4);

  /// Times must rise; a pose at the time of the last one is left out.
  void add(SimTime time, const Pose& world_from_head);
  /// Adds the pose at `time` and those before it, from the last one added on, in equal steps.
  void go_on_to(SimTime time, const std::function<Pose(SimTime)>& world_from_head_at);
  bool can_be_a_trace() const { return poses_.size() >= 2; }
  std::size_t size() const { return poses_.size(); }
  SimTime begin() const { return poses_.empty() ? SimTime() : poses_.front().time; }
  /// Begins at time 0.
  sim::PoseTrace trace() const;

 private:
  std::vector<sim::TimedPose> poses_;
};

}  // namespace brace
