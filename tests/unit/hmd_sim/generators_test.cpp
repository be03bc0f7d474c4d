#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "hmd_sim/random.hpp"
#include "hmd_sim/trace_generators.hpp"
#include "hmd_sim/trace_info.hpp"

namespace brace::sim {
namespace {

constexpr double pi = std::numbers::pi;

TEST(NeckModel, EyesMoveAboutTheBaseOfTheNeck) {
  const glm::dvec3 rest(0.1, 1.6, -0.3);
  const Pose still = pose_about_neck(rest, glm::dquat(1, 0, 0, 0));
  EXPECT_EQ(still.position, rest);
  // A quarter turn to the left takes the lever (0, 0.075, -0.080) to (-0.080, 0.075, 0).
  const Pose turned = pose_about_neck(rest, quat_exp({0.0, pi / 2, 0.0}));
  EXPECT_NEAR(turned.position.x, rest.x - 0.080, 1e-15);
  EXPECT_NEAR(turned.position.y, rest.y, 1e-15);
  EXPECT_NEAR(turned.position.z, rest.z + 0.080, 1e-15);
  // The neck itself does not move.
  const glm::dvec3 neck = turned.position - turned.orientation * neck_to_eyes_m;
  EXPECT_LT(glm::length(neck - (rest - neck_to_eyes_m)), 1e-15);
}

TEST(Generators, RotationIsCosineEasedAboutTheVerticalAxis) {
  for (const double t : {0.0, 0.25, 0.5, 0.9, 1.0, 1.7}) {
    const Pose pose = rotation_pose(60, 1.0, t);
    const double angle = 60 * pi / 180 * 0.5 * (1 - std::cos(pi * std::min(t, 1.0)));
    EXPECT_LT(angle_between_rad(pose.orientation, quat_exp({0.0, angle, 0.0})), 1e-15);
    const glm::dvec3 want =
        standing_eyes_m + glm::dvec3(-0.080 * std::sin(angle), 0, 0.080 * (1 - std::cos(angle)));
    EXPECT_LT(glm::length(pose.position - want), 1e-15);
  }
}

TEST(Generators, TranslationIsCosineEasedSideways) {
  EXPECT_EQ(translation_pose(0.3, 1.0, 0.0).position, standing_eyes_m);
  EXPECT_NEAR(translation_pose(0.3, 1.0, 0.5).position.x, 0.15, 1e-15);
  EXPECT_NEAR(translation_pose(0.3, 1.0, 0.25).position.x, 0.3 * 0.5 * (1 - std::cos(pi / 4)), 1e-15);
  EXPECT_NEAR(translation_pose(0.3, 1.0, 2.0).position.x, 0.3, 1e-15);
  EXPECT_EQ(translation_pose(0.3, 1.0, 0.7).orientation, glm::dquat(1, 0, 0, 0));
}

TEST(Generators, NaturalMotionIsAFunctionOfItsSeedAlone) {
  const PoseTrace a = generate_trace({.motion = Motion::natural, .seconds = 5, .seed = 7, .rate = {90, 1}});
  const PoseTrace b = generate_trace({.motion = Motion::natural, .seconds = 5, .seed = 7, .rate = {90, 1}});
  const PoseTrace c = generate_trace({.motion = Motion::natural, .seconds = 5, .seed = 8, .rate = {90, 1}});
  double distance = 0;
  for (std::size_t i = 0; i < a.poses().size(); ++i) {
    EXPECT_EQ(a.poses()[i].world_from_head.position, b.poses()[i].world_from_head.position);
    EXPECT_EQ(a.poses()[i].world_from_head.orientation, b.poses()[i].world_from_head.orientation);
    distance = std::max(
        distance, glm::length(a.poses()[i].world_from_head.position - c.poses()[i].world_from_head.position));
  }
  EXPECT_GT(distance, 0.01);
}

TEST(Generators, NaturalMotionMovesAsPeopleDo) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const TraceInfo info = trace_info(
        generate_trace({.motion = Motion::natural, .seconds = 60, .seed = seed, .rate = {100, 1}}));
    EXPECT_GT(info.angular_speed_deg_s_mean, 10);
    EXPECT_LT(info.angular_speed_deg_s_mean, 70);
    EXPECT_LT(info.angular_speed_deg_s_max, 200);
    EXPECT_GT(info.linear_speed_m_s_mean, 0.02);
    EXPECT_LT(info.linear_speed_m_s_max, 1.0);
  }
}

TEST(Generators, NaturalMotionIsBandLimited) {
  // No tone above 1.2 Hz: the acceleration of the neck-free yaw is bounded by (2 pi 1.2)^2 times its extent.
  const NaturalMotion motion(3);
  const double h = 1e-3;
  for (double t = 0; t < 20; t += 0.11) {
    const glm::dvec3 a =
        (motion.at(t + h).position - 2.0 * motion.at(t).position + motion.at(t - h).position) / (h * h);
    EXPECT_LT(glm::length(a), std::pow(2 * pi * 1.2, 2) * 0.5);
  }
}

TEST(Generators, TraceCoversItsLengthInWholeNanoseconds) {
  const PoseTrace trace = generate_trace({.motion = Motion::rotation, .seconds = 1, .rate = {90, 1}});
  EXPECT_EQ(trace.poses().size(), 91u);
  EXPECT_EQ(to_ns(trace.end_time()), 1'000'000'000);
  EXPECT_EQ(to_ns(trace.poses()[1].time), 11'111'111);
  const PoseTrace odd = generate_trace({.motion = Motion::stationary, .seconds = 0.105, .rate = {50, 1}});
  EXPECT_EQ(odd.poses().size(), 7u);  // 0, 20, … 100 ms and the end
  EXPECT_EQ(to_ns(odd.end_time()), 105'000'000);
}

TEST(Generators, RefuseWhatHasNoTrace) {
  EXPECT_THROW(generate_trace({.seconds = 0}), Error);
  EXPECT_THROW(generate_trace({.seconds = -1}), Error);
  EXPECT_THROW(generate_trace({.seconds = std::nan("")}), Error);
  EXPECT_THROW(generate_trace({.seconds = 1e9}), Error);
  EXPECT_THROW(generate_trace({.rate = {10, 1}}), Error);
  EXPECT_THROW(generate_trace({.rate = {90, 0}}), Error);
  EXPECT_THROW(generate_trace({.motion = Motion::spin, .degrees_per_s = 1e5, .rate = {90, 1}}), Error);
  EXPECT_THROW(generate_trace({.motion = Motion::translation, .metres = std::nan("")}), Error);
  try {
    parse_motion("rotaton");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'rotation'"));
  }
  EXPECT_EQ(parse_motion("natural"), Motion::natural);
}

TEST(Random, NumbersAreTheSameOnEveryMachine) {
  // First outputs of SplitMix64 from state 0, as published with it.
  EXPECT_EQ(mix64(0), 0xe220a8397b1dcdafu);
  EXPECT_EQ(mix64(0x9e3779b97f4a7c15u), 0x6e789e6aa1b965f4u);
}

TEST(Random, NearNormalHasMean0AndVariance1) {
  double sum = 0, square = 0, largest = 0;
  const int n = 200'000;
  for (int i = 0; i < n; ++i) {
    const double x = near_normal(random_bits(stream_of(5, static_cast<std::uint64_t>(i)), 2));
    sum += x;
    square += x * x;
    largest = std::max(largest, std::abs(x));
  }
  EXPECT_NEAR(sum / n, 0.0, 0.01);
  EXPECT_NEAR(square / n, 1.0, 0.01);
  EXPECT_LT(largest, 3.47);
  EXPECT_GT(largest, 3.0);
}

}  // namespace
}  // namespace brace::sim
