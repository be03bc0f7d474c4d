#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace brace {

// World and head frames follow OpenXR: right-handed, +X right, +Y up, -Z forward, metres.
// Careful: glm::dquat's constructor takes (w, x, y, z).

/// A rigid transform `a_from_b`: x_a = orientation * x_b + position. `orientation` is a unit quaternion.
struct Pose {
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 position{0.0};
};

/// a_from_c = compose(a_from_b, b_from_c).
inline Pose compose(const Pose& a_from_b, const Pose& b_from_c) {
  return {a_from_b.orientation * b_from_c.orientation,
          a_from_b.orientation * b_from_c.position + a_from_b.position};
}

inline Pose inverse(const Pose& a_from_b) {
  const glm::dquat b_from_a = glm::conjugate(a_from_b.orientation);
  return {b_from_a, -(b_from_a * a_from_b.position)};
}

inline glm::dvec3 transform_point(const Pose& a_from_b, const glm::dvec3& point_b) {
  return a_from_b.orientation * point_b + a_from_b.position;
}

/// Unit quaternion of a rotation vector (axis times angle, radians); series near zero.
glm::dquat quat_exp(const glm::dvec3& rotation_vector_rad);

/// Rotation vector of a unit quaternion, |v| <= pi. atan2 form: exact for small angles where acos loses
/// everything below 3e-4 rad in fp32. q and -q give the same result; at pi the axis' first non-zero
/// component is positive.
glm::dvec3 quat_log(const glm::dquat& q);

/// `from` after a turn in its own frame and a shift in the frame it is given in.
inline Pose moved(const Pose& from, const glm::dvec3& turn_rad, const glm::dvec3& shift_m) {
  return {glm::normalize(from.orientation * quat_exp(turn_rad)), from.position + shift_m};
}

/// Angle between two orientations in radians, 0 .. pi.
double angle_between_rad(const glm::dquat& a, const glm::dquat& b);

}  // namespace brace
