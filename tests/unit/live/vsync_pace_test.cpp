#include "tools/live/vsync_pace.hpp"

#include <gtest/gtest.h>

namespace brace {
namespace {

TEST(VsyncPace, ShowsAPictureAtTheFirstVsyncAfterItIsReady) {
  VsyncPace pace({100, 1});  // every 10 ms
  EXPECT_EQ(pace.take(sim_time(3'000'000)).vsync, sim_time(10'000'000));
  EXPECT_EQ(pace.take(sim_time(19'999'999)).vsync, sim_time(20'000'000));
  EXPECT_EQ(pace.take(sim_time(30'000'000)).vsync, sim_time(30'000'000)) << "ready at the vsync is in time";
}

TEST(VsyncPace, CountsVsyncsWithoutANewPictureButNoneBeforeTheFirst) {
  VsyncPace pace({100, 1});
  EXPECT_EQ(pace.take(sim_time(83'000'000)).missed, 0) << "start-up";
  EXPECT_EQ(pace.take(sim_time(99'000'000)).missed, 0);
  EXPECT_EQ(pace.take(sim_time(100'000'001)).missed, 0);
  const VsyncPace::Slot late = pace.take(sim_time(141'000'000));
  EXPECT_EQ(late.vsync, sim_time(150'000'000));
  EXPECT_EQ(late.missed, 3) << "at 120, 130 and 140 ms";
}

TEST(VsyncPace, GivesNoVsyncTwoPictures) {
  VsyncPace pace({100, 1});
  const SimTime early = sim_time(1);
  EXPECT_EQ(pace.take(early).vsync, sim_time(10'000'000));
  EXPECT_EQ(pace.take(early).vsync, sim_time(20'000'000));
}

TEST(VsyncPace, DoesNotDrift) {
  VsyncPace pace(rate_of_hz(90.0));
  SimTime last{};
  for (int i = 0; i < 90 * 60; ++i)
    last = pace.take(last + SimDuration(1)).vsync;
  EXPECT_EQ(last, SimTime(std::chrono::seconds(60)));
}

TEST(VsyncPace, TellsMissesOfAnUnknownDisplayByTheInterval) {
  const sim::Rate rate = rate_of_hz(60.0);
  EXPECT_EQ(missed_in(std::chrono::milliseconds(1), rate), 0);
  EXPECT_EQ(missed_in(std::chrono::milliseconds(17), rate), 0);
  EXPECT_EQ(missed_in(std::chrono::milliseconds(24), rate), 0);
  EXPECT_EQ(missed_in(std::chrono::milliseconds(26), rate), 1);
  EXPECT_EQ(missed_in(std::chrono::milliseconds(100), rate), 5);
}

}  // namespace
}  // namespace brace
