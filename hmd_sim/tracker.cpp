#include "hmd_sim/tracker.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "hmd_sim/random.hpp"
#include "hmd_sim/rotation.hpp"

namespace brace::sim {
namespace {

enum NoiseLane : std::uint64_t { position_lane = 0, orientation_lane = 3, dropout_lane = 6 };

glm::dvec3 noise_vector(std::uint64_t stream, NoiseLane lane) {
  return {near_normal(random_bits(stream, lane)), near_normal(random_bits(stream, lane + 1)),
          near_normal(random_bits(stream, lane + 2))};
}

// A turn by a small rotation vector, right to second order: what its noise is good for.
glm::dquat small_turn(const glm::dvec3& v) {
  return glm::normalize(glm::dquat(1.0, 0.5 * v.x, 0.5 * v.y, 0.5 * v.z));
}

void check(const TrackerModel& model, const TrackerHistoryOptions& options) {
  if (!(model.position_noise_m >= 0.0) || !(model.orientation_noise_rad >= 0.0) ||
      model.orientation_noise_rad > 0.1 || model.latency < SimDuration(0)) {
    throw input_error("tracker: latency and noise must not be negative, orientation noise at most 0.1 rad");
  }
  if (!(model.dropout_probability >= 0.0 && model.dropout_probability <= 0.99)) {
    throw input_error("tracker: dropout_probability = {} is out of range; accepted: 0 to 0.99",
                      model.dropout_probability);
  }
  BRACE_CHECK(options.capacity >= 1 && options.spacing >= SimDuration(0));
}

std::int64_t readings_per_spacing(const TrackerModel& model, SimDuration spacing) {
  const double readings = to_s(spacing) * model.rate.hz();
  return std::max<std::int64_t>(1, std::llround(std::ceil(readings - 1e-9)));
}

void set_velocities(brace_tracker_sample& sample, const Pose& pose, const Pose& before, double interval_s) {
  const glm::dvec3 turn = turn_between(before.orientation, pose.orientation) / interval_s;
  const glm::dvec3 shift = (pose.position - before.position) / interval_s;
  for (int axis = 0; axis < 3; ++axis) {
    sample.angular_velocity_rad_s[axis] = turn[axis];
    sample.linear_velocity_m_s[axis] = shift[axis];
  }
}

}  // namespace

brace_pose to_abi(const Pose& pose) {
  const glm::dquat& q = pose.orientation;
  return {{q.x, q.y, q.z, q.w}, {pose.position.x, pose.position.y, pose.position.z}};
}

Pose from_abi(const brace_pose& pose) {
  const double* q = pose.orientation_xyzw;
  return {glm::dquat(q[3], q[0], q[1], q[2]), {pose.position_m[0], pose.position_m[1], pose.position_m[2]}};
}

Tracker::Tracker(const PoseTrace& trace, const TrackerModel& model, std::uint64_t seed,
                 const TrackerHistoryOptions& options)
    : trace_(trace),
      model_(model),
      seed_(seed),
      options_(options),
      clock_(trace.begin_time(), model.rate),
      stride_(readings_per_spacing(model, options.spacing)),
      last_index_(clock_.last_at_or_before(trace.end_time())),
      samples_(options.capacity) {
  check(model, options);
}

bool Tracker::dropped(std::int64_t index) const {
  if (index == 0 || model_.dropout_probability == 0.0) return false;
  const auto stream = stream_of(seed_, static_cast<std::uint64_t>(index));
  return uniform01(random_bits(stream, dropout_lane)) < model_.dropout_probability;
}

// The newest reading at or before `index`. The trace begins with a pose, so reading 0 always exists.
Tracker::Moment Tracker::newest_existing(std::int64_t index, std::size_t& hint) const {
  while (index > 0) {
    const SimTime time = clock_.time_of(index);
    if (!trace_.valid_at(time, hint)) {
      // In a gap; `hint` is at the pose before it. Go on from there instead of reading by reading.
      index = std::min(index - 1, clock_.last_at_or_before(trace_.poses()[hint].time));
    } else if (dropped(index)) {
      --index;
    } else {
      return {index, time};
    }
  }
  return {0, trace_.begin_time()};
}

Tracker::Moment Tracker::newest_known(SimTime now, std::size_t& hint) const {
  const SimTime asked = now - model_.latency;
  if (asked <= trace_.begin_time()) return {0, trace_.begin_time()};
  return newest_existing(std::min(last_index_, clock_.last_at_or_before(asked)), hint);
}

Pose Tracker::read(const Moment& moment, std::size_t& hint) {
  ++readings_computed_;
  Pose pose = trace_.at(moment.time, options_.interpolation, hint);
  const auto stream = stream_of(seed_, static_cast<std::uint64_t>(moment.index));
  if (model_.position_noise_m > 0.0) {
    pose.position += model_.position_noise_m * noise_vector(stream, position_lane);
  }
  if (model_.orientation_noise_rad > 0.0) {
    pose.orientation = glm::normalize(
        pose.orientation * small_turn(model_.orientation_noise_rad * noise_vector(stream, orientation_lane)));
  }
  return pose;
}

std::span<const brace_tracker_sample> Tracker::history(SimTime now) {
  return collect(now, samples_.size());
}

brace_tracker_sample Tracker::newest(SimTime now) {
  return collect(now, 1).back();
}

// Walks back from the newest reading; each reading serves as a sample and as the base of the next one's
// velocity.
std::span<const brace_tracker_sample> Tracker::collect(SimTime now, std::size_t wanted) {
  Moment moment = newest_known(now, hint_);
  const bool known = samples_.back().time_ns == to_ns(moment.time) && wanted <= collected_;
  if (known) return std::span<const brace_tracker_sample>(samples_).last(collected_);
  std::size_t hint = hint_;
  Pose pose = read(moment, hint);
  std::size_t first = samples_.size();
  while (true) {
    brace_tracker_sample& sample = samples_[--first];
    sample = {to_ns(moment.time), to_abi(pose), {}, {}};
    if (moment.index == 0) break;
    const Moment earlier = newest_existing(std::max<std::int64_t>(moment.index - stride_, 0), hint);
    const Pose before = read(earlier, hint);
    set_velocities(sample, pose, before, to_s(moment.time - earlier.time));
    if (samples_.size() - first == wanted) break;
    moment = earlier;
    pose = before;
  }
  collected_ = samples_.size() - first;
  return std::span<const brace_tracker_sample>(samples_).subspan(first);
}

}  // namespace brace::sim
