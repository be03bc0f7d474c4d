#include "hmd_sim/rotation.hpp"

#include <cmath>

#include <glm/geometric.hpp>

namespace brace::sim {

namespace {

// sin(s x) / sin(x) by its series in 1 - cos(x) (Eberly, "A fast and accurate algorithm for computing slerp",
// 2011), seven terms: exact to the last bits for 1 - cos(x) <= 0.005, without a trigonometric call.
double sine_ratio_small(double s, double one_minus_cos) {
  double series = 1.0;
  for (int i = 6; i >= 1; --i) {
    const double u = 1.0 / (i * (2 * i + 1)), v = static_cast<double>(i) / (2 * i + 1);
    series = 1.0 + (v - u * s * s) * one_minus_cos * series;
  }
  return s * series;
}

}  // namespace

glm::dquat slerp_near(const glm::dquat& a, const glm::dquat& b, double s) {
  // The chord gives the angle without the cancellation of acos(dot).
  const double sign = glm::dot(a, b) < 0.0 ? -1.0 : 1.0;
  const glm::dquat difference = b * sign - a;
  const double chord_sq = glm::dot(difference, difference);
  double weight_a, weight_b;
  if (chord_sq <= 0.01) {
    weight_a = sine_ratio_small(1.0 - s, 0.5 * chord_sq);
    weight_b = sine_ratio_small(s, 0.5 * chord_sq);
  } else if (chord_sq < 1.99999) {
    const double angle = 2.0 * std::asin(0.5 * std::sqrt(chord_sq));
    weight_a = std::sin((1.0 - s) * angle) / std::sin(angle);
    weight_b = std::sin(s * angle) / std::sin(angle);
  } else {  // half a turn apart: either way round is as short
    return a * quat_exp(s * quat_log(glm::conjugate(a) * b));
  }
  return glm::normalize(a * weight_a + b * (sign * weight_b));
}

glm::dvec3 turn_between(const glm::dquat& a, const glm::dquat& b) {
  const glm::dquat turn = glm::conjugate(a) * b;
  const glm::dvec3 v(turn.x, turn.y, turn.z);
  const double s2 = glm::dot(v, v);
  if (s2 > 0.0025 || turn.w <= 0.0) return quat_log(turn);
  // asin(s) / s, to the last bits up to an angle of 0.1.
  const double ratio =
      1.0 + s2 * (1.0 / 6 + s2 * (3.0 / 40 + s2 * (15.0 / 336 + s2 * (105.0 / 3456 + s2 * (945.0 / 42240)))));
  return v * (2.0 * ratio);
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
