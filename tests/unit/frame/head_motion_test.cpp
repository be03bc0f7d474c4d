#include "runtime/frame/head_motion.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

constexpr auto slerp = sim::Interpolation::slerp_linear;

sim::PoseTrace one_second() {
  return sim::generate_trace({.motion = sim::Motion::natural, .seconds = 1});
}

double distance(const Pose& a, const Pose& b) {
  return glm::length(a.position - b.position) + angle_between_rad(a.orientation, b.orientation);
}

TEST(HeadMotion, RunTimeZeroIsTheStart) {
  const sim::PoseTrace trace = one_second();
  HeadMotion head(trace, slerp, {.rate = {1000, 1}}, 1, false, sim_time(250'000'000));
  EXPECT_EQ(head.end_time(), sim_time(750'000'000));
  EXPECT_LE(distance(head.true_pose(sim_time(1'500'000)), trace.at(sim_time(251'500'000), slerp)), 1e-12);
  EXPECT_EQ(head.readings(sim_time(10'000'000)).back().time_ns, 10'000'000);
  EXPECT_TRUE(head.valid_at(sim_time(750'000'000)));
  EXPECT_FALSE(head.valid_at(sim_time(750'000'001)));
}

TEST(HeadMotion, ReadingsAreAsOldAsTheTrackersLatency) {
  const sim::PoseTrace trace = one_second();
  HeadMotion head(trace, slerp, {.rate = {1000, 1}, .latency = ms(7)}, 1, false, sim_time(0));
  EXPECT_EQ(head.readings(sim_time(500'400'000)).back().time_ns, 493'000'000);
}

TEST(HeadMotion, ALoopedTraceRepeatsTruthAndReadingsInRunTime) {
  const sim::PoseTrace trace = one_second();
  HeadMotion head(trace, slerp, {.rate = {1000, 1}, .orientation_noise_rad = 0.01}, 1, true, sim_time(0));
  EXPECT_EQ(head.end_time(), SimTime::max());
  const std::int64_t turn_ns = 1'000'000'000;
  for (const std::int64_t turns : {1LL, 2LL, 86'400LL}) {
    for (const std::int64_t ns : {1LL, 345'678'901LL, 999'999'999LL}) {
      const SimTime later = sim_time(turns * turn_ns + ns);
      EXPECT_TRUE(head.valid_at(later));
      EXPECT_LE(distance(head.true_pose(later), trace.at(sim_time(ns), slerp)), 1e-12);
      const auto in_later_turn = head.readings(later);
      const brace_tracker_sample newest = in_later_turn.back();
      const auto in_first_turn = head.readings(sim_time(ns));
      ASSERT_EQ(in_later_turn.size(), in_first_turn.size());
      EXPECT_EQ(newest.time_ns, in_first_turn.back().time_ns + turns * turn_ns);
      EXPECT_LE(newest.time_ns, to_ns(later));
      EXPECT_EQ(newest.world_from_head.orientation_xyzw[1],
                in_first_turn.back().world_from_head.orientation_xyzw[1]);
    }
  }
}

TEST(HeadMotion, ReadingsNeverComeFromTheFutureNotEvenAtTheSeam) {
  const sim::PoseTrace trace = one_second();
  HeadMotion head(trace, slerp, {.rate = {1000, 1}, .latency = ms(5)}, 1, true, sim_time(0));
  for (std::int64_t ns = 990'000'000; ns < 1'020'000'000; ns += 100'000) {
    ASSERT_LE(head.readings(sim_time(ns)).back().time_ns, ns);
  }
}

TEST(HeadMotion, AStartOutsideTheTraceIsRefused) {
  const sim::PoseTrace trace = one_second();
  EXPECT_THROW(HeadMotion(trace, slerp, {}, 1, false, sim_time(-1)), Error);
  EXPECT_THROW(HeadMotion(trace, slerp, {}, 1, false, sim_time(1'000'000'001)), Error);
}

}  // namespace
}  // namespace brace
