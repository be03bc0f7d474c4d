#include "tools/live/head_readings.hpp"

#include "hmd_sim/rotation.hpp"
#include "hmd_sim/tracker.hpp"

namespace brace {

namespace {

brace_tracker_sample reading_after(const brace_tracker_sample* before, SimTime time, const Pose& pose) {
  brace_tracker_sample reading{};
  reading.time_ns = to_ns(time);
  reading.world_from_head = sim::to_abi(pose);
  if (before == nullptr || reading.time_ns <= before->time_ns) return reading;
  const Pose old = sim::from_abi(before->world_from_head);
  const double seconds = static_cast<double>(reading.time_ns - before->time_ns) * 1e-9;
  const glm::dvec3 turned = sim::turn_between(old.orientation, pose.orientation) / seconds;  // head axes
  const glm::dvec3 moved = (pose.position - old.position) / seconds;
  for (int axis = 0; axis < 3; ++axis) {
    reading.angular_velocity_rad_s[axis] = turned[axis];
    reading.linear_velocity_m_s[axis] = moved[axis];
  }
  return reading;
}

}  // namespace

void HeadReadings::add(SimTime time, const Pose& world_from_head) {
  const std::size_t count = readings_.size();
  if (count >= 2 && readings_[count - 1].time_ns - readings_[count - 2].time_ns < to_ns(spacing_min))
    readings_.pop_back();
  if (!readings_.empty() && to_ns(time) <= readings_.back().time_ns) readings_.pop_back();
  readings_.push_back(reading_after(readings_.empty() ? nullptr : &readings_.back(), time, world_from_head));
  if (readings_.size() > kept) readings_.erase(readings_.begin());
}

}  // namespace brace
