#include "hmd_sim/trace_generators.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "hmd_sim/random.hpp"

namespace brace::sim {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rad_per_deg = pi / 180.0;

constexpr std::array<Motion, 6> all_motions{Motion::rotation,   Motion::translation, Motion::natural,
                                            Motion::stationary, Motion::spin,        Motion::inspect};

glm::dquat about_y(double angle_rad) {
  return quat_exp({0.0, angle_rad, 0.0});
}

constexpr double lowest_hz = 0.08, highest_hz = 1.2;

}  // namespace

double cosine_ease(double time_s, double duration_s) {
  const double t = std::clamp(time_s / duration_s, 0.0, 1.0);
  return 0.5 * (1.0 - std::cos(pi * t));
}

Pose rotation_pose(double degrees, double duration_s, double time_s, const glm::dvec3& eyes_at_rest_m) {
  return pose_about_neck(eyes_at_rest_m, about_y(degrees * rad_per_deg * cosine_ease(time_s, duration_s)));
}

Pose translation_pose(double metres, double duration_s, double time_s, const glm::dvec3& eyes_at_rest_m) {
  return {glm::dquat(1, 0, 0, 0),
          eyes_at_rest_m + glm::dvec3(metres * cosine_ease(time_s, duration_s), 0.0, 0.0)};
}

namespace {

/// 0, 1, 0, -1, 0 at quarters of `duration_s`, eased between; 0 outside.
double to_and_fro(double time_s, double duration_s) {
  const double quarter_s = 0.25 * duration_s;
  return cosine_ease(time_s, quarter_s) - 2.0 * cosine_ease(time_s - quarter_s, 2.0 * quarter_s) +
         cosine_ease(time_s - 3.0 * quarter_s, quarter_s);
}

}  // namespace

Pose inspect_pose(double degrees, double metres, double duration_s, double time_s,
                  const glm::dvec3& eyes_at_rest_m) {
  const double part_s = duration_s / 3.0;
  const double turn = to_and_fro(time_s, part_s), aside = to_and_fro(time_s - part_s, part_s);
  const double near_s = time_s - 2.0 * part_s;
  const double ahead = cosine_ease(near_s, 0.5 * part_s) - cosine_ease(near_s - 0.5 * part_s, 0.5 * part_s);
  return pose_about_neck(eyes_at_rest_m + metres * glm::dvec3(aside, 0.0, -ahead),
                         about_y(degrees * rad_per_deg * turn));
}

NaturalMotion::NaturalMotion(std::uint64_t seed, const glm::dvec3& eyes_at_rest_m)
    : eyes_at_rest_m_(eyes_at_rest_m) {
  // RMS of yaw, pitch, roll (radians) and of the neck's x, y, z (metres): the order of what standing people
  // in recorded headset traces do (mean 20 .. 60 degrees/s, 0.1 .. 0.2 m/s).
  constexpr std::array<double, 6> rms{22 * rad_per_deg, 9 * rad_per_deg, 3 * rad_per_deg, 0.06, 0.02, 0.05};
  for (std::size_t axis = 0; axis < rms.size(); ++axis) {
    double power = 0.0;
    for (std::size_t i = 0; i < tone_count; ++i) {
      const auto random = [&](std::uint64_t what) {
        return uniform01(random_bits(stream_of(seed, axis * tone_count + i), what));
      };
      // One tone at a random place of each of tone_count equal bands of log frequency; amplitude as 1/f,
      // which gives every band the same speed.
      const double place = (static_cast<double>(i) + random(0)) / tone_count;
      Tone& tone = tones_[axis][i];
      tone.frequency_hz = lowest_hz * std::pow(highest_hz / lowest_hz, place);
      tone.amplitude = 1.0 / tone.frequency_hz;
      tone.phase_rad = 2.0 * pi * random(1);
      power += 0.5 * tone.amplitude * tone.amplitude;
    }
    for (Tone& tone : tones_[axis])
      tone.amplitude *= rms[axis] / std::sqrt(power);
  }
}

double NaturalMotion::sum(std::size_t axis, double time_s) const {
  double value = 0.0;
  for (const Tone& tone : tones_[axis]) {
    value += tone.amplitude * std::sin(2.0 * pi * tone.frequency_hz * time_s + tone.phase_rad);
  }
  return value;
}

Pose NaturalMotion::at(double time_s) const {
  const glm::dquat turn =
      about_y(sum(0, time_s)) * quat_exp({sum(1, time_s), 0.0, 0.0}) * quat_exp({0.0, 0.0, sum(2, time_s)});
  const glm::dvec3 neck_shift_m(sum(3, time_s), sum(4, time_s), sum(5, time_s));
  return pose_about_neck(eyes_at_rest_m_ + neck_shift_m, turn);
}

Motion parse_motion(const std::string& name) {
  std::vector<std::string> names;
  for (const Motion motion : all_motions) {
    if (to_string(motion) == name) return motion;
    names.push_back(to_string(motion));
  }
  throw input_error("unknown motion '{}'{}; accepted: {}", name, did_you_mean(name, names), join(names));
}

std::string to_string(Motion motion) {
  switch (motion) {
    case Motion::rotation:
      return "rotation";
    case Motion::translation:
      return "translation";
    case Motion::natural:
      return "natural";
    case Motion::stationary:
      return "stationary";
    case Motion::spin:
      return "spin";
    case Motion::inspect:
      return "inspect";
  }
  return "unknown";
}

Pose motion_pose(const MotionSpec& spec, double time_s) {
  switch (spec.motion) {
    case Motion::rotation:
      return rotation_pose(spec.degrees, spec.seconds, time_s, spec.eyes_at_rest_m);
    case Motion::translation:
      return translation_pose(spec.metres, spec.seconds, time_s, spec.eyes_at_rest_m);
    case Motion::natural:
      return NaturalMotion(spec.seed, spec.eyes_at_rest_m).at(time_s);
    case Motion::stationary:
      break;
    case Motion::spin:
      return pose_about_neck(spec.eyes_at_rest_m, about_y(spec.degrees_per_s * rad_per_deg * time_s));
    case Motion::inspect:
      return inspect_pose(spec.degrees, spec.metres, spec.seconds, time_s, spec.eyes_at_rest_m);
  }
  return {glm::dquat(1, 0, 0, 0), spec.eyes_at_rest_m};
}

namespace {

double fastest_turn_deg_s(const MotionSpec& spec) {
  if (spec.motion == Motion::spin) return std::abs(spec.degrees_per_s);
  if (spec.motion == Motion::rotation) return std::abs(spec.degrees) * 0.5 * pi / spec.seconds;
  if (spec.motion == Motion::inspect) return std::abs(spec.degrees) * 6.0 * pi / spec.seconds;
  return 0.0;
}

void check(const MotionSpec& spec) {
  const std::string name = to_string(spec.motion);
  if (!(spec.seconds > 0.0) || spec.seconds > 1e6) {
    throw input_error("motion '{}': seconds = {} is out of range; accepted: more than 0, at most 1000000",
                      name, spec.seconds);
  }
  if (spec.rate.num <= 0 || spec.rate.den <= 0 || spec.rate.hz() < 20.0 || spec.rate.hz() > 1e5) {
    throw input_error("motion '{}': a rate of {}/{} Hz is out of range; accepted: 20 to 100000 Hz", name,
                      spec.rate.num, spec.rate.den);
  }
  if (spec.seconds * spec.rate.hz() > 2e7) {
    throw input_error("motion '{}': {:.0f} samples are too many; accepted: at most 20000000", name,
                      spec.seconds * spec.rate.hz());
  }
  const bool finite = std::isfinite(spec.degrees) && std::isfinite(spec.metres) &&
                      std::isfinite(spec.degrees_per_s) && std::abs(spec.metres) <= 1e6;
  if (!finite) throw input_error("motion '{}': its extent is not a finite number", name);
  const double turn_deg = fastest_turn_deg_s(spec) * spec.rate.period_s();
  if (turn_deg > 90.0) {
    throw input_error(
        "motion '{}': turns by {:.1f} degrees between two samples; at most 90 are told apart from "
        "a turn the other way: raise the rate",
        name, turn_deg);
  }
}

}  // namespace

PoseTrace generate_trace(const MotionSpec& spec) {
  check(spec);
  const SimTime end = sim_time(0) + from_s(spec.seconds);
  const VsyncClock clock(sim_time(0), spec.rate);
  const NaturalMotion natural(spec.seed, spec.eyes_at_rest_m);
  const auto pose_at = [&](SimTime time) {
    return spec.motion == Motion::natural ? natural.at(to_s(time)) : motion_pose(spec, to_s(time));
  };
  std::vector<TimedPose> poses;
  poses.reserve(static_cast<std::size_t>(spec.seconds * spec.rate.hz()) + 2);
  for (std::int64_t i = 0; clock.time_of(i) <= end; ++i) {
    poses.push_back({clock.time_of(i), pose_at(clock.time_of(i))});
  }
  if (poses.back().time < end) poses.push_back({end, pose_at(end)});
  std::vector<SimTime> times;
  for (const TimedPose& pose : poses)
    times.push_back(pose.time);
  return PoseTrace(to_string(spec.motion), std::move(poses), generate_gaze(spec.gaze, times));
}

}  // namespace brace::sim
