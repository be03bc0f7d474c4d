#include "hmd_sim/kalman_predictor.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "hmd_sim/predictors.hpp"
#include "hmd_sim/trace_generators.hpp"

namespace brace::sim {
namespace {

constexpr std::array one_and_two_frames{SimDuration(11'100'000), SimDuration(22'200'000)};

PoseTrace walking_trace(double (*yaw_rad)(double), double duration_s) {
  std::vector<TimedPose> poses;
  for (int i = 0; i <= static_cast<int>(duration_s * 1000); ++i)
    poses.push_back(
        {sim_time(i * 1'000'000LL), {quat_exp({0, yaw_rad(i * 1e-3), 0}), {0.1 * i * 1e-3, 1.6, 0}}});
  return PoseTrace("yaw", std::move(poses));
}

brace_tracker_sample reading(std::int64_t time_ns, double yaw_rad) {
  brace_tracker_sample sample{};
  sample.time_ns = time_ns;
  sample.world_from_head = to_abi({quat_exp({0, yaw_rad, 0}), {0, 1.6, 0}});
  return sample;
}

void expect_finite_unit(const Pose& pose) {
  EXPECT_NEAR(glm::length(pose.orientation), 1.0, 1e-12);
  EXPECT_TRUE(std::isfinite(glm::length(pose.position)));
}

TEST(SingerStep, HasItsLimitsAtBothEndsOfStiffness) {
  const SingerStep slow = singer_step(1e-3, 1e6);  // acceleration lasts
  EXPECT_NEAR(slow.acceleration_to_angle / 5e-7, 1.0, 1e-9);
  EXPECT_NEAR(slow.acceleration_to_rate / 1e-3, 1.0, 1e-9);
  const SingerStep stiff = singer_step(1.0, 1e-12);  // and is gone at once
  EXPECT_NEAR(stiff.acceleration_to_angle / 1e-12, 1.0, 1e-9);
  EXPECT_EQ(stiff.acceleration_kept, 0.0);
  // Both sides of the series' border.
  for (const double u : {0.00999999, 0.01000001}) {
    const long double exact = u - 1.0L + std::exp(-static_cast<long double>(u));
    EXPECT_NEAR(singer_step(u, 1.0).acceleration_to_angle / static_cast<double>(exact), 1.0, 1e-12);
  }
}

TEST(KalmanCovarianceTest, TwoHalvesOfAStepAreTheStep) {
  const KalmanCovariance start{{{1e-8, 1e-7, 0}, {1e-7, 0.5, 0.1}, {0, 0.1, 30}}};
  for (const double dt_s : {1e-9, 1e-4, 0.004, 0.05, 0.5}) {
    const KalmanCovariance once = propagated(start, dt_s, 0.05, 20);
    const KalmanCovariance twice = propagated(propagated(start, dt_s / 2, 0.05, 20), dt_s / 2, 0.05, 20);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        EXPECT_NEAR(once[i][j], twice[i][j], 1e-8 * std::sqrt(once[i][i] * once[j][j])) << dt_s;
    }
  }
}

TEST(KalmanCovarianceTest, StaysPositiveAtEveryStiffness) {
  for (int exponent = -12; exponent <= 12; ++exponent) {
    const KalmanCovariance p = propagated({}, std::pow(10.0, exponent), 1.0, 20);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_GE(p[i][i], 0.0) << exponent;
      for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_TRUE(std::isfinite(p[i][j])) << exponent;
        EXPECT_LE(p[i][j] * p[i][j], p[i][i] * p[j][j] * (1 + 1e-9)) << exponent;
      }
    }
  }
  // At rest for long, the acceleration has the spread that it was given.
  EXPECT_NEAR(propagated({}, 20.0, 1.0, 20)[2][2], 400.0, 1e-3);
}

TEST(KalmanPredictorTest, FollowsASpinExactly) {
  const PoseTrace spin = walking_trace([](double t) { return 17.45 * t; }, 1.0);
  Tracker tracker(spin, {}, 1);
  KalmanPredictor kalman;
  for (int ms = 5; ms < 900; ms += 5) {
    const SimTime now = sim_time(ms * 1'000'000LL), target = now + one_and_two_frames[1];
    const Pose predicted = kalman.predict(tracker.history(now), target);
    const Pose truth = spin.at(target, Interpolation::slerp_linear);
    if (ms < 400) continue;  // settled
    EXPECT_LT(angle_between_rad(predicted.orientation, truth.orientation), 2e-5) << ms;
    EXPECT_LT(glm::length(predicted.position - truth.position), 1e-6) << ms;
  }
}

TEST(KalmanPredictorTest, HalvesTheErrorOfNoisyReadings) {
  const PoseTrace natural = generate_trace({.motion = Motion::natural, .seconds = 4});
  constexpr double noise = 1e-3;
  KalmanPredictor kalman({.orientation_noise_rad = noise, .position_noise_m = noise});
  const auto errors = [&](const PredictFunction& predict) {
    Tracker tracker(natural, {.position_noise_m = noise, .orientation_noise_rad = noise}, 3);
    return prediction_errors(natural, tracker, predict, one_and_two_frames, SimDuration(5'555'000));
  };
  const auto filtered = errors([&](auto history, auto target) { return kalman.predict(history, target); });
  const auto held = errors(&predict_constant_rate);
  for (std::size_t h = 0; h < one_and_two_frames.size(); ++h) {
    EXPECT_LT(filtered[h].angle_deg.mean, held[h].angle_deg.mean / 2) << h;
    EXPECT_LT(filtered[h].position_mm.mean, held[h].position_mm.mean / 2) << h;
  }
}

TEST(KalmanPredictorTest, SeesEachReadingOnce) {
  const std::array history{reading(0, 0.0), reading(4'000'000, 0.01), reading(8'000'000, 0.02)};
  KalmanPredictor once, often;
  const SimTime target = sim_time(20'000'000);
  const Pose expected = once.predict(history, target);
  for (std::size_t i = 1; i <= history.size(); ++i)
    (void)often.predict(std::span(history).first(i), target);
  const Pose again = often.predict(history, target);
  EXPECT_EQ(expected.orientation, again.orientation);
  EXPECT_EQ(expected.position, again.position);
}

TEST(KalmanPredictorTest, StartsAnewAfterAGapAndWhenTimeGoesBack) {
  KalmanPredictor kalman, fresh;
  std::array moving{reading(0, 0.0), reading(4'000'000, 0.1), reading(8'000'000, 0.2)};
  (void)kalman.predict(moving, sim_time(10'000'000));
  const std::array later{reading(200'000'000, 1.0)};
  EXPECT_NEAR(quat_log(kalman.predict(later, sim_time(300'000'000)).orientation).y, 1.0, 1e-12);
  const std::array back{reading(1'000'000, 0.5)};
  EXPECT_EQ(kalman.predict(back, sim_time(9'000'000)).orientation,
            fresh.predict(back, sim_time(9'000'000)).orientation);
}

TEST(KalmanPredictorTest, StaysFiniteWithoutNoiseAndWithoutMotion) {
  KalmanPredictor exact({.orientation_noise_rad = 0,
                         .position_noise_m = 0,
                         .angular_acceleration_rad_s2 = 0,
                         .linear_acceleration_m_s2 = 0});
  for (int i = 0; i < 1000; ++i) {
    const std::array history{reading(i * 4'000'000LL, 0.001 * i)};
    expect_finite_unit(exact.predict(history, sim_time(i * 4'000'000LL + 44'400'000)));
  }
  // Half a turn between two readings, and a target before the newest of them.
  KalmanPredictor flung;
  const std::array flip{reading(0, 0.0), reading(1, std::numbers::pi)};
  expect_finite_unit(flung.predict(flip, sim_time(1'000'000'000)));
  expect_finite_unit(flung.predict(flip, sim_time(-1'000'000'000)));
}

}  // namespace
}  // namespace brace::sim
