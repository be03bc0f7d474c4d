#include "runtime/frame/describe_record.hpp"

#include <cmath>

#include <glm/geometric.hpp>

namespace brace {

void describe_error(FrameRecord& record, const Pose& shown, const Pose& truth) {
  const glm::dvec3 turn_rad = quat_log(glm::conjugate(truth.orientation) * shown.orientation);
  record.angular_error_vector_rad = {turn_rad.x, turn_rad.y, turn_rad.z};
  record.angular_error_rad = glm::length(turn_rad);
  record.position_error_m = glm::length(shown.position - truth.position);
}

glm::dvec3 describe_gaze(FrameRecord& record, GazeMotion* gaze, const glm::dvec3& known, SimTime photon) {
  if (gaze == nullptr) return sim::straight_ahead;
  const glm::dvec3 truth = gaze->true_at(photon);
  const glm::dvec2 tan = sim::gaze_tangents(truth);
  record.gaze_x = tan.x;
  record.gaze_y = tan.y;
  record.gaze_error_rad = std::atan2(glm::length(glm::cross(known, truth)), glm::dot(known, truth));
  return truth;
}

}  // namespace brace
