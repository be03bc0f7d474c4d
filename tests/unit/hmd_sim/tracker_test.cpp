#include "hmd_sim/tracker.hpp"

#include <cmath>
#include <cstring>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "hmd_sim/trace_generators.hpp"
#include "hmd_sim/trace_io.hpp"

namespace brace::sim {
namespace {

using std::chrono::milliseconds;

PoseTrace natural() {
  return generate_trace({.motion = Motion::natural, .seconds = 4, .seed = 2, .rate = {500, 1}});
}

bool same(const brace_tracker_sample& a, const brace_tracker_sample& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(Tracker, NewestReadingIsAsOldAsTheLatencyAndOnTheTrackersGrid) {
  const PoseTrace trace = natural();
  Tracker tracker(trace, {.rate = {1000, 1}, .latency = milliseconds(2)}, 1);
  const brace_tracker_sample s = tracker.newest(sim_time(1'234'567'890));
  EXPECT_EQ(s.time_ns, 1'232'000'000);
  const Pose want = trace.at(sim_time(s.time_ns), Interpolation::slerp_linear);
  EXPECT_LT(glm::length(from_abi(s.world_from_head).position - want.position), 1e-15);
  EXPECT_LT(angle_between_rad(from_abi(s.world_from_head).orientation, want.orientation), 1e-15);
}

TEST(Tracker, VelocitiesAreThoseOfTheMotion) {
  const PoseTrace spin =
      generate_trace({.motion = Motion::spin, .degrees_per_s = 1000, .seconds = 1, .rate = {1000, 1}});
  Tracker tracker(spin, {}, 1);
  for (const brace_tracker_sample& s : tracker.history(sim_time(500'000'000))) {
    EXPECT_NEAR(s.angular_velocity_rad_s[1], 1000 * std::numbers::pi / 180, 1e-6);
    EXPECT_NEAR(s.angular_velocity_rad_s[0], 0.0, 1e-9);
  }
  const PoseTrace step =
      generate_trace({.motion = Motion::translation, .metres = 0.3, .seconds = 1, .rate = {1000, 1}});
  Tracker mover(step, {}, 1);
  const double speed = mover.newest(sim_time(500'000'000)).linear_velocity_m_s[0];
  EXPECT_NEAR(speed, 0.3 * 0.5 * std::numbers::pi, 1e-3);
}

TEST(Tracker, HistoryIsOldestFirstWithTheStatedSpacing) {
  const PoseTrace trace = natural();
  Tracker tracker(trace, {}, 1, {.capacity = 5, .spacing = milliseconds(4)});
  const auto history = tracker.history(sim_time(2'000'500'000));
  ASSERT_EQ(history.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(history[i].time_ns, 2'000'000'000 - 4'000'000 * static_cast<std::int64_t>(4 - i));
  }
}

TEST(Tracker, BeforeAndAtTheBeginThereIsTheFirstReadingAtRest) {
  const PoseTrace trace = natural();
  Tracker tracker(trace, {.latency = milliseconds(3)}, 1);
  for (const std::int64_t ns : {-5'000'000LL, 0LL, 2'000'000LL}) {
    const auto history = tracker.history(sim_time(ns));
    ASSERT_EQ(history.size(), 1u);
    EXPECT_EQ(history[0].time_ns, 0);
    EXPECT_EQ(history[0].angular_velocity_rad_s[1], 0.0);
  }
  EXPECT_EQ(tracker.history(sim_time(3'000'000 + 6'000'000)).size(), 3u);  // 6, 2 and 0 ms
  // After the trace's end the newest reading stays.
  EXPECT_EQ(tracker.newest(sim_time(9'000'000'000)).time_ns, to_ns(trace.end_time()));
}

TEST(Tracker, ResultsDoNotDependOnTheOrderOfCalls) {
  const PoseTrace trace = natural();
  const TrackerModel model{.rate = {1000, 1},
                           .latency = milliseconds(2),
                           .position_noise_m = 1e-3,
                           .orientation_noise_rad = 1e-3,
                           .dropout_probability = 0.2};
  Tracker forward(trace, model, 9), backward(trace, model, 9), other_seed(trace, model, 10);
  std::vector<brace_tracker_sample> seen;
  for (int i = 0; i < 300; ++i) {
    const auto history = forward.history(sim_time(11'111'111LL * i));
    seen.insert(seen.end(), history.begin(), history.end());
  }
  std::size_t at = seen.size();
  int differing = 0;
  for (int i = 299; i >= 0; --i) {
    const SimTime now = sim_time(11'111'111LL * i);
    backward.newest(now);
    const auto history = backward.history(now);
    at -= history.size();
    for (std::size_t k = 0; k < history.size(); ++k)
      EXPECT_TRUE(same(history[k], seen[at + k])) << i;
    differing += !same(other_seed.newest(now), history.back());
  }
  EXPECT_EQ(at, 0u);
  EXPECT_GT(differing, 280);
}

TEST(Tracker, NoiseHasTheStatedDeviation) {
  const PoseTrace still = generate_trace({.motion = Motion::stationary, .seconds = 20, .rate = {100, 1}});
  Tracker tracker(still, {.position_noise_m = 0.002, .orientation_noise_rad = 0.003}, 5, {.capacity = 1});
  double position_sq = 0, angle_sq = 0;
  int n = 0;
  for (int ms = 1; ms < 20'000; ++ms, ++n) {
    const Pose pose = from_abi(tracker.newest(sim_time(ms * 1'000'000LL)).world_from_head);
    position_sq += std::pow(pose.position.x - standing_eyes_m.x, 2);
    angle_sq += std::pow(quat_log(pose.orientation).z, 2);
  }
  EXPECT_NEAR(std::sqrt(position_sq / n), 0.002, 0.0001);
  EXPECT_NEAR(std::sqrt(angle_sq / n), 0.003, 0.00015);
}

TEST(Tracker, DropOutsLoseTheStatedShareOfReadings) {
  const PoseTrace still = generate_trace({.motion = Motion::stationary, .seconds = 10, .rate = {100, 1}});
  Tracker tracker(still, {.dropout_probability = 0.3}, 5);
  int fresh = 0;
  for (int ms = 1; ms <= 10'000; ++ms) {
    const std::int64_t now = ms * 1'000'000LL;
    fresh += tracker.newest(sim_time(now)).time_ns == now;
  }
  EXPECT_NEAR(fresh / 10'000.0, 0.7, 0.02);
}

TEST(Tracker, ReadsNothingInsideAGapHoweverLong) {
  const glm::dquat q(1, 0, 0, 0);
  std::vector<TimedPose> poses;
  for (int i = 0; i < 20; ++i)
    poses.push_back({sim_time(i * 10'000'000LL), {q, {0.001 * i, 0, 0}}});
  for (int i = 0; i < 20; ++i)
    poses.push_back({sim_time(3600'000'000'000 + i * 10'000'000LL), {q, {1, 0, 0}}});
  const PoseTrace trace("gap", poses);
  Tracker tracker(trace, {}, 1);
  EXPECT_EQ(tracker.newest(sim_time(1800'000'000'000)).time_ns, 190'000'000);
  EXPECT_EQ(tracker.newest(sim_time(3600'050'000'000)).time_ns, 3600'050'000'000);
  // The history reaches across the gap without a reading in it.
  const auto history = tracker.history(sim_time(3600'004'000'000));
  ASSERT_EQ(history.size(), 4u);
  EXPECT_EQ(history[2].time_ns, 3600'000'000'000);
  EXPECT_EQ(history[1].time_ns, 190'000'000);
}

TEST(Tracker, ComputesOnlyTheReadingsThatAreLookedAt) {
  const PoseTrace trace = natural();
  Tracker tracker(trace, {.rate = {1000, 1}}, 1, {.capacity = 4});
  for (int i = 10; i < 110; ++i) {
    const SimTime vsync = sim_time(11'111'111LL * i);
    tracker.history(vsync);
    tracker.newest(vsync);   // known already
    tracker.history(vsync);  // known already
  }
  EXPECT_EQ(tracker.readings_computed(), 100u * 5u);
}

TEST(Tracker, QuantisedRecordingsGiveFiniteUnitReadings) {
  const PoseTrace trace =
      read_trace(std::filesystem::path(BRACE_SOURCE_DIR) / "traces/iwer_quest3_90hz.trace").trace;
  Tracker tracker(trace, {.position_noise_m = 1e-4, .orientation_noise_rad = 1e-4}, 1);
  for (SimTime now = trace.begin_time(); now < trace.end_time(); now += SimDuration(11'111'111)) {
    for (const brace_tracker_sample& s : tracker.history(now)) {
      const Pose pose = from_abi(s.world_from_head);
      EXPECT_NEAR(glm::dot(pose.orientation, pose.orientation), 1.0, 1e-12);
      EXPECT_LT(std::abs(s.angular_velocity_rad_s[1]), 10.0);
    }
  }
}

TEST(Tracker, RefusesAModelOutOfRange) {
  const PoseTrace trace = natural();
  EXPECT_THROW(Tracker(trace, {.latency = milliseconds(-1)}, 1), Error);
  EXPECT_THROW(Tracker(trace, {.position_noise_m = -1}, 1), Error);
  EXPECT_THROW(Tracker(trace, {.orientation_noise_rad = std::nan("")}, 1), Error);
  EXPECT_THROW(Tracker(trace, {.dropout_probability = 1.0}, 1), Error);
  EXPECT_THROW(Tracker(trace, {.rate = {0, 1}}, 1), Error);
}

}  // namespace
}  // namespace brace::sim
