#pragma once

#include "base/pose.hpp"

namespace brace::sim {

/// Constant-rate rotation from a to b, 0 <= s <= 1, on the shorter arc; a and b unit. At an angle of exactly
/// pi the axis is quat_log's.
glm::dquat slerp_near(const glm::dquat& a, const glm::dquat& b, double s);

/// Rotation vector of a^-1 b: quat_log without its atan2 for the small turns between neighbouring readings.
glm::dvec3 turn_between(const glm::dquat& a, const glm::dquat& b);

/// d(phi)/dt of the chart q = q0 exp(phi), given the body rate omega (head frame) there: the inverse right
/// Jacobian of SO(3). Finite for |phi| <= pi.
glm::dvec3 chart_rate_from_body_rate(const glm::dvec3& phi, const glm::dvec3& omega);

}  // namespace brace::sim
