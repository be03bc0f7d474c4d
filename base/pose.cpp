#include "base/pose.hpp"

#include <cmath>

namespace brace {

glm::dquat quat_exp(const glm::dvec3& rotation_vector_rad) {
  const double angle_sq = glm::dot(rotation_vector_rad, rotation_vector_rad);
  const double angle = std::sqrt(angle_sq);
  // sin(a/2)/a by its series where the quotient loses digits.
  const double sinc_half = angle < 1e-4 ? 0.5 - angle_sq / 48.0 : std::sin(0.5 * angle) / angle;
  const glm::dvec3 v = rotation_vector_rad * sinc_half;
  return glm::dquat(std::cos(0.5 * angle), v.x, v.y, v.z);
}

glm::dvec3 quat_log(const glm::dquat& q) {
  glm::dvec3 v(q.x, q.y, q.z);
  double w = q.w;
  if (w < 0.0) {
    w = -w;
    v = -v;
  }
  const double s = glm::length(v);
  if (s < 1e-9) return v * (2.0 / w);
  if (w == 0.0) {
    const double first = v.x != 0.0 ? v.x : (v.y != 0.0 ? v.y : v.z);
    if (first < 0.0) v = -v;
  }
  return v * (2.0 * std::atan2(s, w) / s);
}

double angle_between_rad(const glm::dquat& a, const glm::dquat& b) {
  return glm::length(quat_log(glm::conjugate(a) * b));
}

}  // namespace brace
