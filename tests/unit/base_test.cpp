#include <cmath>

#include <gtest/gtest.h>

#include "base/pose.hpp"

namespace brace {

TEST(Pose, ExpAndLogRoundTripFromTinyToHalfTurn) {
  for (double angle : {0.0, 1e-300, 1e-12, 1e-8, 1e-4, 0.1, 1.0, 3.0, 3.14159}) {
    const glm::dvec3 v = angle * glm::normalize(glm::dvec3(1.0, -2.0, 0.5));
    EXPECT_LE(glm::length(quat_log(quat_exp(v)) - v), 1e-15 + 1e-12 * angle) << angle;
  }
}

TEST(Pose, LogIsTheSameForBothSigns) {
  const glm::dquat q = quat_exp({0.3, -1.2, 2.0});
  EXPECT_LE(glm::length(quat_log(q) - quat_log(-q)), 1e-15);
}

TEST(Pose, InverseUndoesCompose) {
  const Pose a{quat_exp({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}};
  const Pose identity = compose(a, inverse(a));
  EXPECT_LE(glm::length(identity.position), 1e-15);
  EXPECT_LE(angle_between_rad(identity.orientation, Pose{}.orientation), 1e-15);
}

}  // namespace brace
