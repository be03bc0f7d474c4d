#include "tools/live/head_control.hpp"

#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "hmd_sim/neck_model.hpp"

namespace brace {
namespace {

double angle_between(const glm::dquat& a, const glm::dquat& b) {
  return glm::length(quat_log(glm::conjugate(a) * b));
}

TEST(HeadControl, GoesOnFromAPoseWithoutAJump) {
  for (const double yaw : {-3.0, -0.5, 0.0, 2.0})
    for (const double pitch : {-1.0, 0.0, 0.9}) {
      const Pose pose{quat_exp({0, yaw, 0}) * quat_exp({pitch, 0, 0}), {0.3, 1.6, -2.0}};
      HeadControl control;
      control.start_from(pose);
      EXPECT_LT(angle_between(control.pose().orientation, pose.orientation), 1e-9);
      EXPECT_LT(glm::distance(control.pose().position, pose.position), 1e-9);
    }
}

TEST(HeadControl, TurnsAboutTheNeckAndMovesWhereItLooks) {
  HeadControl control;
  control.advance({.turn_right_rad = std::numbers::pi / 2}, 0.1);
  const Pose turned = control.pose();
  EXPECT_LT(glm::distance(turned.orientation * glm::dvec3(0, 0, -1), glm::dvec3(1, 0, 0)), 1e-12);
  // The eyes are 8 cm before the neck: they have gone round it.
  EXPECT_NEAR(turned.position.x, 0.08, 1e-12);
  EXPECT_NEAR(turned.position.z, 0.08, 1e-12);
  control.advance({.forward = 1.0}, 2.0);
  EXPECT_NEAR(control.pose().position.x - turned.position.x, 2.0 * HeadControl::speed_m_s, 1e-12);
  EXPECT_NEAR(control.pose().position.z, turned.position.z, 1e-12);
}

TEST(HeadControl, LooksNoFurtherUpThanANeckDoes) {
  HeadControl control;
  control.advance({.turn_up_rad = 100.0}, 0.1);
  const glm::dvec3 forward = control.pose().orientation * glm::dvec3(0, 0, -1);
  EXPECT_NEAR(std::asin(forward.y), HeadControl::pitch_rad_max, 1e-9);
}

TEST(HeadRecording, BecomesATraceWhateverTheSignsOfItsQuaternions) {
  HeadRecording recording;
  EXPECT_FALSE(recording.can_be_a_trace());
  for (int i = 0; i < 50; ++i) {
    Pose pose{quat_exp({0, 0.2 * i, 0}), {0.01 * i, 0, 0}};
    if (i % 3 == 0) pose.orientation = -pose.orientation;
    recording.add(SimTime(SimDuration(1'000'000'000 + i * 20'000'000)), pose);
    recording.add(SimTime(SimDuration(1'000'000'000 + i * 20'000'000)), pose);  // the same time again
  }
  ASSERT_TRUE(recording.can_be_a_trace());
  const sim::PoseTrace trace = recording.trace();
  EXPECT_EQ(trace.poses().size(), 50U);
  EXPECT_EQ(trace.begin_time(), SimTime());
  EXPECT_LT(
      angle_between(trace.at(SimTime(SimDuration(400'000'000)), sim::Interpolation::slerp_linear).orientation,
                    quat_exp({0, 4.0, 0})),
      1e-9);
}

TEST(HeadRecording, HasWhatLiesBetweenPictures) {
  const auto at = [](SimTime time) {
    const double s = to_s(time - SimTime());
    return Pose{quat_exp({0, std::sin(20.0 * s), 0}), {0.1 * s, 0, 0}};
  };
  HeadRecording recording;
  for (const double s : {0.5, 0.6, 0.601, 0.9})
    recording.go_on_to(SimTime(from_s(s)), at);
  const sim::PoseTrace trace = recording.trace();
  EXPECT_EQ(recording.begin(), SimTime(from_s(0.5)));
  for (std::size_t i = 1; i < trace.poses().size(); ++i)
    EXPECT_LE(trace.poses()[i].time - trace.poses()[i - 1].time, HeadRecording::spacing_max);
  for (double s = 0.0; s < 0.4; s += 0.0123) {
    const Pose found = trace.at(SimTime(from_s(s)), sim::Interpolation::hermite),
               wanted = at(SimTime(from_s(0.5 + s)));
    EXPECT_LT(angle_between_rad(found.orientation, wanted.orientation), 1e-3) << s;
    EXPECT_LT(glm::distance(found.position, wanted.position), 1e-6) << s;
  }
}

}  // namespace
}  // namespace brace
