#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

constexpr QueueKind queues[] = {QueueKind::single, QueueKind::priority, QueueKind::dual};
constexpr Pace paces[] = {Pace::vsync, Pace::free};
constexpr WarpPose warps[] = {WarpPose::none, WarpPose::rotation, WarpPose::rotation_and_translation};

/// What holds in every run, whatever the load.
void expect_sound(const RunRecords& records, const FrameLoopResult& result) {
  std::int64_t last_frame = -1, stale = 0, index = 0;
  for (const FrameRecord& r : records.frames()) {
    ASSERT_EQ(r.vsync_index, index++);
    ASSERT_GE(r.displayed_frame, last_frame) << "frames never go back";
    if (r.displayed_frame < 0) {
      ASSERT_FALSE(r.missed);
      continue;
    }
    stale = r.missed ? stale + 1 : 0;
    ASSERT_EQ(r.stale_run, stale);
    if (r.missed) {
      ASSERT_EQ(r.displayed_frame, last_frame);
    }
    last_frame = r.displayed_frame;
    ASSERT_LE(r.render_pose_ns, r.render_start_ns);
    ASSERT_LE(r.render_start_ns, r.render_done_ns);
    ASSERT_LE(r.render_done_ns, r.warp_start_ns);
    ASSERT_LE(r.warp_start_ns, r.warp_done_ns);
    ASSERT_LE(r.warp_done_ns, r.vsync_ns) << "nothing is shown before it is done";
    ASSERT_LE(r.warp_pose_ns, r.warp_start_ns) << "no pose from the future";
    ASSERT_GE(r.warp_pose_ns, r.render_pose_ns);
    ASSERT_TRUE(std::isfinite(r.angular_error_rad));
    ASSERT_TRUE(std::isfinite(r.position_error_m));
    ASSERT_NEAR(std::hypot(r.angular_error_vector_rad[0], r.angular_error_vector_rad[1],
                           r.angular_error_vector_rad[2]),
                r.angular_error_rad, 1e-12);
  }
  ASSERT_EQ(static_cast<std::int64_t>(records.frames().size()), result.vsyncs);
}

TEST(FrameLoopExtremes, EveryLoadQueuePaceAndWarpGivesSoundRecordsAndNoDuplicatePrediction) {
  const double period_ms = 1000.0 / 90;
  const double casts_ms[] = {
      0.0, 1e-6, period_ms / 2, period_ms - 1e-6, period_ms, period_ms + 1e-6, 100 * period_ms};
  const double warps_ms[] = {0.0, 1.0, period_ms, 100 * period_ms};
  for (const QueueKind queue : queues) {
    for (const Pace pace : paces) {
      for (const WarpPose warp : warps) {
        Rig rig({.motion = sim::Motion::natural, .seconds = 1});
        rig.config.queue = queue;
        rig.config.pace = pace;
        rig.config.warp_pose = warp;
        for (const double cast_ms : casts_ms) {
          // Nearly free casts at free pace are up to 10,000 a second: a few vsyncs will do.
          rig.config.vsyncs_max = pace == Pace::free && cast_ms < 1 ? 9 : 90;
          for (const double warp_ms : warps_ms) {
            SCOPED_TRACE(testing::Message() << "cast " << cast_ms << " warp " << warp_ms);
            const RunRecords records = rig.run(cast_ms, warp_ms);
            expect_sound(records, rig.result);
            if (testing::Test::HasFatalFailure()) return;
            if (pace == Pace::vsync) {
              ASSERT_EQ(rig.result.duplicate_predictions, 0);
            }
          }
        }
      }
    }
  }
}

TEST(FrameLoopExtremes, RandomLoadsGiveSoundRecordsAndNoDuplicatePrediction) {
  std::uint64_t seed = 1;
  for (const QueueKind queue : queues) {
    for (const Pace pace : paces) {
      for (const WarpPose warp : warps) {
        for (const double most_ms : {1.0, 15.0, 200.0}) {
          Rig rig({.motion = sim::Motion::natural, .seconds = 1.5});
          rig.config.queue = queue;
          rig.config.pace = pace;
          rig.config.warp_pose = warp;
          RandomCost cost(++seed, most_ms, most_ms / 10);
          RunRecords records;
          const FrameLoopResult result = rig.run(records, cost);
          expect_sound(records, result);
          if (testing::Test::HasFatalFailure()) return;
          if (pace == Pace::vsync) {
            ASSERT_EQ(result.duplicate_predictions, 0);
          }
        }
      }
    }
  }
}

TEST(FrameLoopExtremes, FreeJobsAreShownAtEveryVsync) {
  Rig rig;
  const RunRecords records = rig.run(0.0, 0.0);
  for (const FrameRecord& r : records.frames()) {
    ASSERT_FALSE(r.missed);
    if (r.vsync_index > 0) {
      ASSERT_EQ(r.displayed_frame, r.vsync_index - 1);
    }
  }
}

TEST(FrameLoopExtremes, FreeJobsAtFreePaceKeepTheIntervalAndEnd) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 1});
  rig.config.pace = Pace::free;
  const RunRecords records = rig.run(0.0, 0.0);
  const auto frames = static_cast<double>(rig.result.eye_frames_finished);
  EXPECT_NEAR(frames, static_cast<double>(records.frames().back().vsync_ns) / 1e5, 3);
}

TEST(FrameLoopExtremes, ACastOfExactlyOnePeriodIsSeenEveryVsyncTwoLater) {
  Rig rig;
  rig.config.queue = QueueKind::dual;
  RunRecords records;
  class OnePeriod final : public CostSource {
   public:
    SimDuration cost(const CostQuery& query) override {
      if (query.kind != JobKind::cast) return SimDuration(500'000);
      return SimDuration(vsync_ns(query.index + 1) - vsync_ns(query.index));
    }
    bool deterministic() const override { return true; }
  } cost;
  rig.run(records, cost);
  for (const FrameRecord& r : records.frames()) {
    if (r.vsync_index < 2) continue;
    ASSERT_EQ(r.displayed_frame, r.vsync_index - 2);
    ASSERT_FALSE(r.missed);
  }
}

TEST(FrameLoopExtremes, AHundredPeriodsOfCastingLeaveTheWarpsOfADualGpuUntouched) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 5});
  rig.config.queue = QueueKind::dual;
  const RunRecords records = rig.run(100 * 1000.0 / 90, 1.0);
  for (const FrameRecord& r : records.frames()) {
    ASSERT_FALSE(r.missed);
    // Started at a vsync, 100 periods, seen by the warps of the 100 periods after that.
    if (r.displayed_frame >= 0) {
      ASSERT_LT(r.frame_age_ns, 205'000'000 * 11LL);
    }
  }
  EXPECT_EQ(records.frames().back().displayed_frame, 3);
}

TEST(FrameLoopExtremes, AlternatingCostsAreSeenInOrderAndPredictedForDifferentVsyncs) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 5});
  rig.config.queue = QueueKind::dual;
  class Alternating final : public CostSource {
   public:
    SimDuration cost(const CostQuery& query) override {
      return query.kind == JobKind::warp ? ms(1) : ms(query.index % 2 == 0 ? 0.1 : 43);
    }
    bool deterministic() const override { return true; }
  } cost;
  RunRecords records;
  const FrameLoopResult result = rig.run(records, cost);
  expect_sound(records, result);
  EXPECT_EQ(result.duplicate_predictions, 0);
  // 1 vsync for the cheap one, 4 for the dear one: 2 frames per 5 vsyncs.
  EXPECT_NEAR(static_cast<double>(result.eye_frames_finished), 5 * 90 * 2 / 5.0, 3);
}

TEST(FrameLoopExtremes, ALoadThatDropsRevisesPredictionsInsteadOfStayingTooFarAhead) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 5});
  rig.config.queue = QueueKind::dual;
  const RunRecords records = rig.run({{0, 100, 1, 0}, {2, 3, 1, 0}});
  EXPECT_EQ(rig.result.duplicate_predictions, 0);
  EXPECT_GT(rig.result.revised_predictions, 0);
  const FrameRecord& last = records.frames().back();
  EXPECT_EQ(last.render_target_ns, last.photon_mid_ns);
}

TEST(FrameLoopExtremes, AThousandDegreesPerSecondStaysFinite) {
  Rig rig({.motion = sim::Motion::spin, .degrees_per_s = 1000, .seconds = 1}, {.rate = {1000, 1},
                                                                               .latency = ms(4),
                                                                               .position_noise_m = 0.001,
                                                                               .orientation_noise_rad = 0.01,
                                                                               .dropout_probability = 0.3});
  for (const auto* predictor : {&stages::predict_none, &stages::predict_constant_rate,
                                &stages::predict_constant_acceleration, &stages::predict_kalman}) {
    rig.predictor = predictor;
    expect_sound(rig.run(50.0, 1.0), rig.result);
  }
}

TEST(FrameLoopExtremes, ATraceTooShortForOneVsyncSaysSo) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 0.004});
  try {
    rig.run(1.0, 1.0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), testing::HasSubstr("4.000 ms"));
  }
}

TEST(FrameLoopExtremes, NumbersOfVsyncsBelowOneAndEndlessRunsAreRefused) {
  Rig rig;
  rig.config.vsyncs_max = 0;
  EXPECT_THROW(rig.run(1.0, 1.0), Error);
  rig.config.vsyncs_max.reset();
  rig.loop = true;
  EXPECT_THROW(rig.run(1.0, 1.0), Error);
}

TEST(FrameLoopExtremes, VsyncsInAGapOfTheTraceAreMarkedAndHaveNoError) {
  std::vector<sim::TimedPose> poses;
  for (int i = 0; i <= 1000; ++i) {
    if (i > 400 && i < 600) continue;
    poses.push_back({sim_time(i * 1'000'000LL), {}});
  }
  Rig rig;
  rig.trace = sim::PoseTrace("with a gap", poses);
  const RunRecords records = rig.run(3.0, 1.0);
  std::int64_t gap = 0;
  for (const FrameRecord& r : records.frames()) {
    const bool inside = r.photon_mid_ns > 400'000'000 && r.photon_mid_ns < 600'000'000;
    ASSERT_EQ(r.pose_valid, !inside) << r.photon_mid_ns;
    if (r.displayed_frame < 0) continue;
    ASSERT_EQ(std::isnan(r.angular_error_rad), inside);
    ASSERT_FALSE(r.missed) << "pacing does not depend on the trace";
    gap += inside ? 1 : 0;
  }
  EXPECT_EQ(gap, 18);  // 200 ms at 90 Hz
}

}  // namespace
}  // namespace brace
