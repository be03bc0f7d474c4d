#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "hmd_sim/gaze.hpp"
#include "hmd_sim/neck_model.hpp"
#include "hmd_sim/pose_trace.hpp"
#include "hmd_sim/vsync.hpp"

namespace brace::sim {

// Head motions with a formula. Positions: head = middle between the eyes, at rest at `eyes_at_rest_m`, facing
// -Z.

inline constexpr glm::dvec3 standing_eyes_m{0.0, 1.6, 0.0};

/// 0 → 1 over 0 ≤ t ≤ duration as (1 - cos(pi t / duration)) / 2, constant outside (Buchacher 2017,
/// sec. 6.2).
double cosine_ease(double time_s, double duration_s);

/// The head turns by `degrees` about the vertical axis through the base of its neck.
Pose rotation_pose(double degrees, double duration_s, double time_s,
                   const glm::dvec3& eyes_at_rest_m = standing_eyes_m);
/// The base of the neck moves by `metres` to the right.
Pose translation_pose(double metres, double duration_s, double time_s,
                      const glm::dvec3& eyes_at_rest_m = standing_eyes_m);

/// Band-limited wandering of a standing person about the neck: sums of sinusoids with random phases, all
/// below 1.2 Hz. A pure function of (seed, time).
class NaturalMotion {
 public:
  explicit NaturalMotion(std::uint64_t seed, const glm::dvec3& eyes_at_rest_m = standing_eyes_m);
  Pose at(double time_s) const;

 private:
  static constexpr std::size_t tone_count = 12;
  struct Tone {
    double amplitude, frequency_hz, phase_rad;
  };
  double sum(std::size_t axis, double time_s) const;
  Tone tones_[6][tone_count];  // yaw, pitch, roll (radians), x, y, z of the neck (metres)
  glm::dvec3 eyes_at_rest_m_;
};

/// Someone looks at a thing from all sides: in equal parts of `duration_s` the head turns by `degrees` to the
/// left and to the right, the neck moves by `metres` to the right and to the left, and forwards and back,
/// each cosine-eased. To stand at half the distance is to see the thing at twice the size: the third part is
/// the scaling of Waschk and Krueger's recorded interactions.
Pose inspect_pose(double degrees, double metres, double duration_s, double time_s,
                  const glm::dvec3& eyes_at_rest_m = standing_eyes_m);

enum class Motion { rotation, translation, natural, stationary, spin, inspect };

/// `[trace] neck = { motion = "rotation", degrees = 60, seconds = 1 }` and `brace trace generate`.
struct MotionSpec {
  Motion motion = Motion::rotation;
  double degrees = 60;          // rotation, inspect
  double metres = 0.3;          // translation, inspect
  double degrees_per_s = 1000;  // spin about the vertical axis through the neck
  double seconds = 1;           // length of the trace
  std::uint64_t seed = 1;       // natural
  Rate rate{1000, 1};           // samples of the trace; at least 20 Hz, or every interval would be a gap
  glm::dvec3 eyes_at_rest_m = standing_eyes_m;
  GazeSpec gaze{};
};

/// "rotation" … → Motion; throws input_error listing the names.
Motion parse_motion(const std::string& name);
std::string to_string(Motion motion);

/// The exact pose of a motion at a time.
Pose motion_pose(const MotionSpec& spec, double time_s);

/// Samples a motion from time 0 to `seconds`, both included. Throws input_error for a length or rate out of
/// range (0 < seconds <= 10^6, 20 <= rate <= 10^5 Hz, at most 2 * 10^7 samples, a turn of at most 90 degrees
/// between samples).
PoseTrace generate_trace(const MotionSpec& spec);

}  // namespace brace::sim
