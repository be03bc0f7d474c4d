#include "hmd_sim/gaze.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "hmd_sim/random.hpp"

namespace brace::sim {
namespace {

constexpr double rad_per_degree = std::numbers::pi / 180.0;

/// Streams of the seed.
constexpr std::uint64_t rest_stream = 0, place_stream = 1, phase_stream = 2, blink_stream = 3;

/// Fixations one after the other, saccades between them, in angles (yaw, pitch); asked for at rising times.
class Saccades {
 public:
  explicit Saccades(std::uint64_t seed) : seed_(seed) { aim(rest_s()); }

  glm::dvec2 at(double time_s) {
    while (time_s > land_s_ + rest_s()) {
      from_ = to_;
      aim(land_s_ + rest_s());
    }
    if (time_s <= leave_s_) return from_;
    const double s = std::min((time_s - leave_s_) / (land_s_ - leave_s_), 1.0);
    return from_ + s * s * s * (10.0 - s * (15.0 - 6.0 * s)) * (to_ - from_);
  }

 private:
  void aim(double leave_s) {
    leave_s_ = leave_s;
    ++index_;
    to_ = place();
    land_s_ = leave_s_ + saccade_duration_s(glm::distance(from_, to_));
  }
  /// Of the fixation at hand.
  double rest_s() const { return 0.2 + 0.3 * uniform01(random_bits(stream_of(seed_, rest_stream), index_)); }
  glm::dvec2 place() const {
    const auto axis = [&](std::uint64_t lane) {
      return 10.0 * near_normal(random_bits(stream_of(seed_, place_stream), 2 * index_ + lane));
    };
    const glm::dvec2 degrees(axis(0), axis(1));
    return degrees * (rad_per_degree * std::min(1.0, 25.0 / std::max(glm::length(degrees), 1e-9)));
  }

  std::uint64_t seed_, index_ = 0;
  glm::dvec2 from_{0.0}, to_{0.0};
  double leave_s_ = 0.0, land_s_ = 0.0;
};

glm::dvec2 pursuit_at(std::uint64_t seed, double time_s) {
  const auto phase = [&](std::uint64_t lane) {
    return 2.0 * std::numbers::pi * uniform01(random_bits(stream_of(seed, phase_stream), lane));
  };
  const double turn = 2.0 * std::numbers::pi * time_s;
  return rad_per_degree *
         glm::dvec2(12.0 * std::sin(0.25 * turn + phase(0)), 8.0 * std::sin(0.17 * turn + phase(1)));
}

/// Whether the eye is shut, asked for at rising times: intervals are exponential.
class Blinks {
 public:
  Blinks(double per_minute, std::uint64_t seed)
      : mean_s_(60.0 / per_minute), seed_(seed), begin_s_(pause_s()) {}

  bool shut(double time_s) {
    constexpr double blink_s = 0.15;
    while (time_s > begin_s_ + blink_s)
      begin_s_ += blink_s + pause_s();
    return time_s >= begin_s_;
  }

 private:
  double pause_s() {
    return -mean_s_ * std::log1p(-uniform01(random_bits(stream_of(seed_, blink_stream), count_++)));
  }

  double mean_s_;
  std::uint64_t seed_, count_ = 0;
  double begin_s_;
};

}  // namespace

glm::dvec3 direction_of_angles(double yaw_rad, double pitch_rad) {
  return {-std::sin(yaw_rad) * std::cos(pitch_rad), std::sin(pitch_rad),
          -std::cos(yaw_rad) * std::cos(pitch_rad)};
}

glm::dvec2 gaze_tangents(const glm::dvec3& direction) {
  const glm::dvec2 aside(direction.x, direction.y);
  const double ahead = -direction.z, reach = std::max(std::abs(aside.x), std::abs(aside.y));
  if (ahead > 0.0 && reach <= gaze_tan_max * ahead) return aside / ahead;
  return reach > 0.0 ? aside * (gaze_tan_max / reach) : glm::dvec2(0.0);
}

glm::dvec3 direction_of_tangents(const glm::dvec2& tan) {
  return glm::normalize(glm::dvec3(tan, -1.0));
}

EyeMotion parse_eye_motion(const std::string& name) {
  const std::vector<std::string> names = {"none", "saccades", "pursuit"};
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw input_error("unknown gaze '{}'{}; accepted: {}", name, did_you_mean(name, names), join(names));
  return static_cast<EyeMotion>(found - names.begin());
}

double saccade_duration_s(double amplitude_rad) {
  return 0.021 + 0.0022 * amplitude_rad / rad_per_degree;
}

std::vector<glm::dvec3> generate_gaze(const GazeSpec& spec, const std::vector<SimTime>& times) {
  if (spec.motion == EyeMotion::none) return {};
  if (!(spec.blinks_per_minute >= 0.0 && spec.blinks_per_minute <= 120.0)) {
    throw input_error("{} blinks per minute; accepted: 0 to 120", spec.blinks_per_minute);
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Saccades saccades(spec.seed);
  Blinks blinks(std::max(spec.blinks_per_minute, 1e-9), spec.seed);
  std::vector<glm::dvec3> gaze;
  for (const SimTime time : times) {
    const double t = to_s(time - times.front());
    const glm::dvec2 angles = spec.motion == EyeMotion::saccades ? saccades.at(t) : pursuit_at(spec.seed, t);
    const bool shut = spec.blinks_per_minute > 0.0 && blinks.shut(t);
    gaze.push_back(shut ? glm::dvec3(nan) : glm::normalize(direction_of_angles(angles.x, angles.y)));
  }
  return gaze;
}

}  // namespace brace::sim
