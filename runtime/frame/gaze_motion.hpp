#pragma once

#include <vector>

#include "hmd_sim/gaze.hpp"
#include "runtime/frame/head_motion.hpp"

namespace brace {

/// A place of a scripted gaze: tangents (right, up) in the head frame.
struct GazePoint {
  SimTime time;
  glm::dvec2 tan{0.0};
};

/// The eyes of a run: where they truly look, and what the eye tracker has told of it. Unit vectors in the
/// head frame, at run times.
class GazeMotion {
 public:
  /// As the trace says; `head` must outlive it. `latency`: from an eye's movement until it is known.
  GazeMotion(HeadMotion& head, SimDuration latency) : head_(&head), latency_(latency) {}
  /// Straight from one place to the next, at the first before it and at the last after it. Times do not fall;
  /// equal ones are a jump. Throws input_error for no place and for falling times.
  GazeMotion(std::vector<GazePoint> script, SimDuration latency);

  glm::dvec3 true_at(SimTime time);
  glm::dvec3 known_at(SimTime now) { return true_at(now - latency_); }

 private:
  HeadMotion* head_ = nullptr;
  std::vector<GazePoint> script_;
  SimDuration latency_;
};

}  // namespace brace
