#include "hmd_sim/pose_trace.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "hmd_sim/rotation.hpp"
#include "hmd_sim/trace_generators.hpp"
#include "hmd_sim/trace_info.hpp"

namespace brace::sim {
namespace {

using Motion3d = std::function<Pose(double)>;

// A turn about axes that do not commute, and a curve.
Pose tumbling(double t) {
  return {quat_exp({0.0, 1.3 * std::sin(2.1 * t), 0.0}) * quat_exp({0.7 * std::cos(1.7 * t), 0.0, 0.0}) *
              quat_exp({0.0, 0.0, 0.4 * t}),
          {std::sin(t), std::cos(1.3 * t), 0.2 * t * t}};
}

PoseTrace sampled(const Motion3d& motion, double interval_s, double duration_s, double jitter = 0.0) {
  std::vector<TimedPose> poses;
  const int count = static_cast<int>(std::lround(duration_s / interval_s)) + 1;
  for (int i = 0; i < count; ++i) {
    const double t = interval_s * (i + jitter * std::sin(12.9898 * i));
    const SimTime time = sim_time(0) + from_s(t);
    Pose pose = motion(to_s(time));
    if (i > 0 && glm::dot(poses.back().world_from_head.orientation, pose.orientation) < 0) {
      pose.orientation = -pose.orientation;
    }
    poses.push_back({time, pose});
  }
  return PoseTrace("sampled", std::move(poses));
}

struct Errors {
  double angle_rad = 0, position_m = 0;
};

Errors worst(const PoseTrace& trace, Interpolation interpolation) {
  Errors errors;
  std::size_t hint = 0;
  for (SimTime t = trace.begin_time(); t <= trace.end_time(); t += SimDuration(1'234'567)) {
    const Pose got = trace.at(t, interpolation, hint), want = tumbling(to_s(t));
    errors.angle_rad = std::max(errors.angle_rad, angle_between_rad(got.orientation, want.orientation));
    errors.position_m = std::max(errors.position_m, glm::length(got.position - want.position));
  }
  return errors;
}

double order(double coarse, double fine) {
  return std::log2(coarse / fine);
}

TEST(PoseTrace, SlerpHasObservedOrder2AndHermite4) {
  const PoseTrace coarse = sampled(tumbling, 0.04, 4.0), fine = sampled(tumbling, 0.02, 4.0);
  const Errors slerp_coarse = worst(coarse, Interpolation::slerp_linear);
  const Errors slerp_fine = worst(fine, Interpolation::slerp_linear);
  EXPECT_NEAR(order(slerp_coarse.angle_rad, slerp_fine.angle_rad), 2.0, 0.1);
  EXPECT_NEAR(order(slerp_coarse.position_m, slerp_fine.position_m), 2.0, 0.1);
  const Errors hermite_coarse = worst(fine, Interpolation::hermite);
  const Errors hermite_fine = worst(sampled(tumbling, 0.01, 4.0), Interpolation::hermite);
  EXPECT_NEAR(order(hermite_coarse.angle_rad, hermite_fine.angle_rad), 4.0, 0.3);
  EXPECT_NEAR(order(hermite_coarse.position_m, hermite_fine.position_m), 4.0, 0.3);
  EXPECT_LT(hermite_coarse.angle_rad, slerp_fine.angle_rad / 100);
}

TEST(PoseTrace, HermiteKeepsItsOrderWithUnevenIntervals) {
  const Errors coarse = worst(sampled(tumbling, 0.03, 3.0, 0.2), Interpolation::hermite);
  const Errors fine = worst(sampled(tumbling, 0.015, 3.0, 0.2), Interpolation::hermite);
  EXPECT_GT(order(coarse.angle_rad, fine.angle_rad), 3.5);
}

TEST(PoseTrace, PosesAreMetExactlyAndEndsAreClamped) {
  const PoseTrace trace = sampled(tumbling, 0.01, 0.2);
  for (const auto interpolation : {Interpolation::slerp_linear, Interpolation::hermite}) {
    for (const TimedPose& pose : trace.poses()) {
      const Pose got = trace.at(pose.time, interpolation);
      EXPECT_EQ(got.orientation, pose.world_from_head.orientation);
      EXPECT_EQ(got.position, pose.world_from_head.position);
    }
    EXPECT_EQ(trace.at(sim_time(-5), interpolation).position, trace.poses().front().world_from_head.position);
    EXPECT_EQ(trace.at(sim_time(1'000'000'000'000), interpolation).position,
              trace.poses().back().world_from_head.position);
  }
}

TEST(PoseTrace, HintDoesNotChangeTheResultWhereverItPoints) {
  const PoseTrace trace = sampled(tumbling, 0.01, 2.0);
  for (const std::size_t start : {std::size_t{0}, std::size_t{100}, std::size_t{200}, std::size_t{100000}}) {
    for (const std::int64_t ns : {0LL, 5'000'000LL, 999'999'999LL, 1'000'000'000LL, 1'994'000'000LL}) {
      std::size_t hint = start;
      const Pose hinted = trace.at(sim_time(ns), Interpolation::slerp_linear, hint);
      EXPECT_EQ(hinted.position, trace.at(sim_time(ns), Interpolation::slerp_linear).position);
      EXPECT_EQ(hinted.orientation, trace.at(sim_time(ns), Interpolation::slerp_linear).orientation);
    }
  }
}

TEST(PoseTrace, GapsAreInvalidAndNotBridged) {
  const glm::dquat ahead(1, 0, 0, 0);
  const PoseTrace trace("gap", {{sim_time(0), {ahead, {0, 0, 0}}},
                                {sim_time(50'000'000), {ahead, {1, 0, 0}}},     // exactly 50 ms: no gap
                                {sim_time(100'000'001), {ahead, {2, 0, 0}}}});  // 1 ns more: a gap
  EXPECT_TRUE(trace.valid_at(sim_time(25'000'000)));
  EXPECT_TRUE(trace.valid_at(sim_time(50'000'000)));
  EXPECT_FALSE(trace.valid_at(sim_time(50'000'001)));
  EXPECT_FALSE(trace.valid_at(sim_time(100'000'000)));
  EXPECT_TRUE(trace.valid_at(sim_time(100'000'001)));
  EXPECT_FALSE(trace.valid_at(sim_time(-1)));
  EXPECT_FALSE(trace.valid_at(sim_time(100'000'002)));
  for (const auto interpolation : {Interpolation::slerp_linear, Interpolation::hermite}) {
    EXPECT_EQ(trace.at(sim_time(99'000'000), interpolation).position.x, 1.0);
    EXPECT_NEAR(trace.at(sim_time(25'000'000), interpolation).position.x, 0.5, 1e-12);
  }
}

TEST(PoseTrace, SpinAt1000DegreesPerSecondIsExactBetweenSamples) {
  const PoseTrace trace =
      generate_trace({.motion = Motion::spin, .degrees_per_s = 1000, .seconds = 2, .rate = {90, 1}});
  for (const double t : {0.0051, 0.7777, 1.3333, 1.999}) {
    const SimTime time = sim_time(0) + from_s(t);
    const glm::dquat want = quat_exp({0.0, 1000 * std::numbers::pi / 180 * to_s(time), 0.0});
    for (const auto interpolation : {Interpolation::slerp_linear, Interpolation::hermite}) {
      EXPECT_LT(angle_between_rad(trace.at(time, interpolation).orientation, want), 1e-6);
    }
  }
}

TEST(PoseTrace, TurnOfPiBetweenTwoPosesIsFiniteAndUnit) {
  for (const double angle : {std::numbers::pi, std::numbers::pi - 1e-9, std::numbers::pi - 1e-3}) {
    const glm::dquat a(1, 0, 0, 0);
    glm::dquat b = quat_exp({0.0, angle, 0.0});
    if (glm::dot(a, b) < 0) b = -b;
    const PoseTrace trace("pi", {{sim_time(0), {a, {0, 0, 0}}}, {sim_time(10'000'000), {b, {0, 0, 0}}}});
    for (const auto interpolation : {Interpolation::slerp_linear, Interpolation::hermite}) {
      const Pose middle = trace.at(sim_time(5'000'000), interpolation);
      EXPECT_NEAR(glm::dot(middle.orientation, middle.orientation), 1.0, 1e-12);
      EXPECT_NEAR(angle_between_rad(middle.orientation, a), angle / 2, 1e-6);
    }
  }
}

TEST(PoseTrace, InvariantIsCheckedWithTheNameAndPose) {
  const glm::dquat q(1, 0, 0, 0);
  EXPECT_THROW(PoseTrace("none", {}), Error);
  EXPECT_THROW(PoseTrace("one", {{sim_time(0), {q, {}}}}), Error);
  EXPECT_THROW(PoseTrace("same time", {{sim_time(5), {q, {}}}, {sim_time(5), {q, {}}}}), Error);
  EXPECT_THROW(PoseTrace("sign", {{sim_time(0), {q, {}}}, {sim_time(5), {-q, {}}}}), Error);
  EXPECT_THROW(PoseTrace("length", {{sim_time(0), {q, {}}}, {sim_time(5), {q * 1.001, {}}}}), Error);
  EXPECT_THROW(PoseTrace("nan", {{sim_time(0), {q, {}}}, {sim_time(5), {q, {std::nan(""), 0, 0}}}}), Error);
}

TEST(Rotation, SlerpAgreesWithTheLogOnBothSidesOfItsSeries) {
  for (const double angle : {1e-12, 1e-7, 1e-3, 0.1, 0.19, 0.2002, 0.21, 1.0, 3.0}) {
    const glm::dquat a = quat_exp({0.3, -0.2, 0.9}),
                     b = a * quat_exp(angle * glm::normalize(glm::dvec3(1, 2, -1)));
    for (const double s : {0.0, 0.123, 0.5, 0.9, 1.0}) {
      const glm::dquat want = a * quat_exp(s * quat_log(glm::conjugate(a) * b));
      EXPECT_LT(angle_between_rad(slerp_near(a, b, s), want), 4e-15) << angle;
      EXPECT_LT(angle_between_rad(slerp_near(a, -b, s), want), 4e-15) << angle;
    }
    EXPECT_LT(glm::length(turn_between(a, b) - quat_log(glm::conjugate(a) * b)), 4e-15);
  }
}

TEST(TraceInfo, StatesWhatASpinDoes) {
  const TraceInfo info = trace_info(
      generate_trace({.motion = Motion::spin, .degrees_per_s = 200, .seconds = 1, .rate = {100, 1}}));
  EXPECT_EQ(info.poses, 101u);
  EXPECT_NEAR(info.duration_s, 1.0, 1e-12);
  EXPECT_NEAR(info.rate_hz, 100.0, 1e-9);
  EXPECT_NEAR(info.angular_speed_deg_s_max, 200.0, 1e-6);
  EXPECT_NEAR(info.angular_speed_deg_s_mean, 200.0, 1e-6);
  EXPECT_EQ(info.gaps, 0u);
  EXPECT_EQ(info.duplicates, 0u);
}

TEST(TraceInfo, ShiftingMovesTimesAndNothingElse) {
  const PoseTrace trace = sampled(tumbling, 0.01, 0.1);
  const PoseTrace moved = shifted_to(trace, sim_time(7'000));
  EXPECT_EQ(to_ns(moved.begin_time()), 7'000);
  EXPECT_EQ(moved.end_time() - moved.begin_time(), trace.end_time() - trace.begin_time());
  EXPECT_EQ(moved.poses()[3].world_from_head.position, trace.poses()[3].world_from_head.position);
}

}  // namespace
}  // namespace brace::sim
