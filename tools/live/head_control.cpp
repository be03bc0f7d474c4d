#include "tools/live/head_control.hpp"

#include <algorithm>
#include <cmath>

#include "hmd_sim/neck_model.hpp"

namespace brace {

glm::dquat HeadControl::rotation() const {
  return quat_exp({0.0, yaw_rad_, 0.0}) * quat_exp({pitch_rad_, 0.0, 0.0});
}

void HeadControl::start_from(const Pose& world_from_head) {
  const glm::dvec3 forward = world_from_head.orientation * glm::dvec3(0.0, 0.0, -1.0);
  yaw_rad_ = std::atan2(-forward.x, -forward.z);
  pitch_rad_ = std::clamp(std::asin(std::clamp(forward.y, -1.0, 1.0)), -pitch_rad_max, pitch_rad_max);
  const Pose about_origin = sim::pose_about_neck(glm::dvec3(0.0), rotation());
  eyes_at_rest_m_ = world_from_head.position - about_origin.position;
}

void HeadControl::advance(const HeadInput& input, double seconds) {
  yaw_rad_ -= input.turn_right_rad;
  pitch_rad_ = std::clamp(pitch_rad_ + input.turn_up_rad, -pitch_rad_max, pitch_rad_max);
  const glm::dquat heading = quat_exp({0.0, yaw_rad_, 0.0});
  eyes_at_rest_m_ += heading * glm::dvec3(input.right, input.up, -input.forward) * (speed_m_s * seconds);
}

Pose HeadControl::pose() const {
  return sim::pose_about_neck(eyes_at_rest_m_, rotation());
}

void HeadRecording::add(SimTime time, const Pose& world_from_head) {
  if (!poses_.empty() && time <= poses_.back().time) return;
  Pose pose = world_from_head;
  // Of the two quaternions of a rotation the one beside the last.
  if (!poses_.empty() && glm::dot(poses_.back().world_from_head.orientation, pose.orientation) < 0.0)
    pose.orientation = -pose.orientation;
  poses_.push_back({time, pose});
}

void HeadRecording::go_on_to(SimTime time, const std::function<Pose(SimTime)>& world_from_head_at) {
  if (!poses_.empty() && time > poses_.back().time) {
    const SimTime from = poses_.back().time;
    const std::int64_t steps = (time - from + spacing_max - SimDuration(1)) / spacing_max;
    for (std::int64_t step = 1; step < steps; ++step) {
      const SimTime between = from + (time - from) * step / steps;
      add(between, world_from_head_at(between));
    }
  }
  add(time, world_from_head_at(time));
}

sim::PoseTrace HeadRecording::trace() const {
  std::vector<sim::TimedPose> poses = poses_;
  for (sim::TimedPose& pose : poses)
    pose.time -= poses_.front().time - SimTime();
  return sim::PoseTrace("live", std::move(poses));
}

}  // namespace brace
