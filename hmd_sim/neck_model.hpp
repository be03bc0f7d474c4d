#pragma once

#include "base/pose.hpp"

namespace brace::sim {

/// Lever from the base of the neck to the middle between the eyes, head frame, metres (Peek et al. as used by
/// Buchacher 2017, section 6.2).
inline constexpr glm::dvec3 neck_to_eyes_m{0.0, 0.075, -0.080};

/// World-from-head pose (head origin: middle between the eyes) when the head has turned about the base of its
/// neck: p = p0 + R n - n. `eyes_at_rest_m` is p0, where the eyes are when R is the identity.
inline Pose pose_about_neck(const glm::dvec3& eyes_at_rest_m, const glm::dquat& rotation) {
  return {rotation, eyes_at_rest_m + rotation * neck_to_eyes_m - neck_to_eyes_m};
}

}  // namespace brace::sim
