#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/pose.hpp"
#include "base/time.hpp"

namespace brace::sim {

// Where the eyes look: unit vectors in the head frame, straight ahead is -Z. Both eyes look along the same
// direction: that they turn towards each other for what is near is left out.

/// Radians, to the left (about +Y) and up.
glm::dvec3 direction_of_angles(double yaw_rad, double pitch_rad);

/// Tangents (right, up) of a direction. What looks further aside than `gaze_tan_max`, or backwards, is
/// brought back to there, in its direction.
inline constexpr double gaze_tan_max = 4.0;
glm::dvec2 gaze_tangents(const glm::dvec3& direction);
glm::dvec3 direction_of_tangents(const glm::dvec2& tan);

enum class EyeMotion { none, saccades, pursuit };
/// Throws input_error listing the names.
EyeMotion parse_eye_motion(const std::string& name);

struct GazeSpec {
  EyeMotion motion = EyeMotion::none;
  double blinks_per_minute = 0;  // readings lost for 150 ms each, at random
  std::uint64_t seed = 1;
};

/// How long a saccade takes: 21 ms + 2.2 ms per degree (Carpenter 1988, of the "main sequence" of Bahill,
/// Clark and Stark 1975). Along it the eye goes as 10 s^3 - 15 s^4 + 6 s^5, so that its peak velocity
/// is 1.875 amplitudes over that time: 81, 436 and 577 degrees/s for 1, 10 and 20 degrees.
double saccade_duration_s(double amplitude_rad);

/// Gaze at rising times, a reading each, NaN in blinks; empty for EyeMotion::none.
/// saccades: fixations of 0.2 to 0.5 s at places of 10 degrees RMS per axis around straight ahead, within 25;
/// pursuit: a smooth curve of 12 x 8 degrees at 0.25 and 0.17 Hz, up to 21 degrees/s, which eyes can follow.
std::vector<glm::dvec3> generate_gaze(const GazeSpec& spec, const std::vector<SimTime>& times);

}  // namespace brace::sim
