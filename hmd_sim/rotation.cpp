#include "hmd_sim/rotation.hpp"

#include <cmath>

#include <glm/geometric.hpp>

namespace brace::sim {

glm::dquat slerp_near(const glm::dquat& a, const glm::dquat& b, double s) {
  // Half the chord gives the half angle without the cancellation of acos(dot).
  const double sign = glm::dot(a, b) < 0.0 ? -1.0 : 1.0;
  const glm::dquat difference = b * sign - a;
  const double sin_half = 0.5 * std::sqrt(glm::dot(difference, difference));
  if (sin_half > 0.7071) return a * quat_exp(s * quat_log(glm::conjugate(a) * b));  // 180 degrees apart
  const double angle = 2.0 * std::asin(sin_half);
  double weight_a = 1.0 - s, weight_b = s;
  if (angle > 1e-6) {  // below, sin(x) = x to the last bit
    const double inverse_sine = 1.0 / std::sin(angle);
    weight_a = std::sin((1.0 - s) * angle) * inverse_sine;
    weight_b = std::sin(s * angle) * inverse_sine;
  }
  return glm::normalize(a * weight_a + b * (sign * weight_b));
}

glm::dvec3 chart_rate_from_body_rate(const glm::dvec3& phi, const glm::dvec3& omega) {
  const double angle_sq = glm::dot(phi, phi);
  const double angle = std::sqrt(angle_sq);
  // (1 - (x/2) cot(x/2)) / x^2, by its series near 0.
  const double c =
      angle < 1e-3 ? 1.0 / 12.0 + angle_sq / 720.0 : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / angle_sq;
  return omega + 0.5 * glm::cross(phi, omega) + c * glm::cross(phi, glm::cross(phi, omega));
}

}  // namespace brace::sim
