#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

std::int64_t missed_count(const RunRecords& records) {
  std::int64_t missed = 0;
  for (const FrameRecord& r : records.frames())
    missed += r.missed ? 1 : 0;
  return missed;
}

TEST(FrameLoop, CheapFramesAreSeenAtTheNextVsyncEach) {
  Rig rig;
  rig.config.warp_lead = ms(2);
  const RunRecords records = rig.run(4.0, 1.0);
  const std::int64_t half_period_ns = 5'555'555;
  ASSERT_GT(records.frames().size(), 100U);
  for (const FrameRecord& r : records.frames()) {
    const std::int64_t k = r.vsync_index;
    ASSERT_EQ(r.vsync_ns, vsync_ns(k));
    ASSERT_NEAR(static_cast<double>(r.photon_mid_ns - r.vsync_ns), half_period_ns, 2);
    ASSERT_FALSE(r.missed);
    if (k == 0) {
      ASSERT_EQ(r.displayed_frame, -1);
      ASSERT_EQ(r.render_done_ns, -1);
      continue;
    }
    ASSERT_EQ(r.displayed_frame, k - 1);
    ASSERT_EQ(r.render_start_ns, vsync_ns(k - 1));
    ASSERT_EQ(r.render_done_ns, vsync_ns(k - 1) + 4'000'000);
    ASSERT_EQ(r.render_pose_ns, floor_to_ms(vsync_ns(k - 1)));  // readings at whole milliseconds, no latency
    ASSERT_EQ(r.warp_start_ns, vsync_ns(k) - 2'000'000);
    ASSERT_EQ(r.warp_done_ns, vsync_ns(k) - 1'000'000);
    ASSERT_EQ(r.warp_pose_ns, floor_to_ms(vsync_ns(k) - 2'000'000));
    ASSERT_EQ(r.mtp_rotation_ns, r.photon_mid_ns - r.warp_pose_ns);
    ASSERT_EQ(r.mtp_translation_ns, r.photon_mid_ns - r.render_pose_ns);
    ASSERT_EQ(r.frame_age_ns, r.vsync_ns - r.render_pose_ns);
    ASSERT_EQ(r.render_target_ns, r.photon_mid_ns) << "the vsync was predicted right from the first frame on";
  }
  EXPECT_EQ(rig.result.duplicate_predictions, 0);
  EXPECT_EQ(rig.result.revised_predictions, 0);
}

TEST(FrameLoop, WhereRotationAndTranslationComeFromFollowsTheWarp) {
  for (const WarpPose warp : {WarpPose::none, WarpPose::rotation, WarpPose::rotation_and_translation}) {
    Rig rig;
    rig.config.warp_pose = warp;
    rig.config.queue = QueueKind::dual;
    const RunRecords records = rig.run(25.0, 1.0);
    for (const FrameRecord& r : records.frames()) {
      if (r.displayed_frame < 0) continue;
      const bool rotates = warp != WarpPose::none, moves = warp == WarpPose::rotation_and_translation;
      ASSERT_EQ(r.mtp_rotation_ns, r.photon_mid_ns - (rotates ? r.warp_pose_ns : r.render_pose_ns));
      ASSERT_EQ(r.mtp_translation_ns, r.photon_mid_ns - (moves ? r.warp_pose_ns : r.render_pose_ns));
      if (!rotates) {
        ASSERT_EQ(r.warp_pose_ns, r.render_pose_ns);
      }
      if (rotates) {
        ASSERT_GT(r.warp_pose_ns, r.render_pose_ns);
      }
    }
  }
}

TEST(FrameLoop, WithoutAWarpARepeatedEyeFrameIsAMiss) {
  Rig rig;
  rig.config.warp_pose = WarpPose::none;
  const RunRecords records = rig.run(15.0, 0.5);  // two periods per eye frame
  std::int64_t images = 0;
  for (const FrameRecord& r : records.frames()) {
    if (r.displayed_frame < 0) continue;
    const bool first =
        images == 0 ||
        records.frames()[static_cast<std::size_t>(r.vsync_index - 1)].displayed_frame != r.displayed_frame;
    ASSERT_EQ(r.missed, !first);
    ASSERT_EQ(r.stale_run, first ? 0 : 1);
    ++images;
  }
  EXPECT_EQ(missed_count(records), images / 2);
  // And no work was done for the repeats.
  EXPECT_LE(rig.result.warps, rig.result.eye_frames_finished);
}

TEST(FrameLoop, SlowCastsOnTheirOwnGpuOrPreemptedCostNoVsync) {
  for (const QueueKind queue : {QueueKind::dual, QueueKind::priority}) {
    Rig rig;
    rig.config.queue = queue;
    rig.config.warp_margin = ms(0);  // the lead alone must do
    const RunRecords records = rig.run(37.0, 1.0);
    EXPECT_EQ(missed_count(records), 0);
    for (const FrameRecord& r : records.frames()) {
      if (r.displayed_frame >= 0) {
        ASSERT_LT(r.mtp_rotation_ns, 15'000'000);
      }
    }
    EXPECT_EQ(rig.result.duplicate_predictions, 0);
    EXPECT_EQ(rig.result.revised_predictions, 0);
  }
}

TEST(FrameLoop, SlowCastsOnASingleQueueMissTheVsyncsTheyCover) {
  // 3.6 periods of casting: the warp for a vsync waits behind the cast.
  Rig rig;
  const RunRecords records = rig.run(40.0, 1.0);
  for (std::size_t i = 0; i < records.frames().size(); ++i) {
    const FrameRecord& r = records.frames()[i];
    if (r.displayed_frame < 0) continue;
    const bool shown_at_once = r.warp_done_ns > (i > 0 ? records.frames()[i - 1].vsync_ns : -1);
    ASSERT_EQ(r.missed, !shown_at_once) << i;
  }
  const double ratio =
      static_cast<double>(missed_count(records)) / static_cast<double>(records.frames().size());
  EXPECT_NEAR(ratio, 0.75, 0.03);  // a cast and a warp take 4 periods, of which one shows something new
}

TEST(FrameLoop, ALateImageIsShownAtTheFirstVsyncAfterItAndNoOtherWarpStartsBefore) {
  Rig rig;
  rig.config.warp_lead = ms(1);
  rig.config.queue = QueueKind::dual;
  const RunRecords records = rig.run(2.0, 1.5);  // each warp is half a millisecond late
  for (const FrameRecord& r : records.frames()) {
    if (r.vsync_index < 2) continue;
    ASSERT_EQ(r.missed, r.vsync_index % 2 == 1) << r.vsync_index;
    if (!r.missed) {
      ASSERT_EQ(r.warp_start_ns, vsync_ns(r.vsync_index - 1) - 1'000'000);
    }
  }
}

TEST(FrameLoop, AWarpDoneExactlyAtItsVsyncIsInTimeAndANanosecondLaterIsNot) {
  for (const std::int64_t late_ns : {0, 1}) {
    Rig rig;
    rig.config.warp_lead = SimDuration(1'000'000 - late_ns);
    rig.config.queue = QueueKind::dual;
    const RunRecords records = rig.run(2.0, 1.0);
    EXPECT_EQ(records.frames()[1].displayed_frame, late_ns == 0 ? 0 : -1);
  }
}

TEST(FrameLoop, TheDefaultLeadIsTheDearestOfTheLastEightWarpsPlusAMargin) {
  Rig rig;
  rig.config.warp_margin = ms(0.3);
  const RunRecords records = rig.run({{0, 2, 1, 0}, {1, 2, 3, 0}});
  // Steady parts: the first warps (a quarter of a period is assumed) and the step are left out.
  for (const FrameRecord& r : records.frames()) {
    if (r.vsync_index < 12 || (r.vsync_index > 88 && r.vsync_index < 94)) continue;
    const std::int64_t lead_ns = r.vsync_index < 90 ? 1'300'000 : 3'300'000;
    ASSERT_EQ(r.warp_start_ns, r.vsync_ns - lead_ns) << r.vsync_index;
  }
}

TEST(FrameLoop, FreePaceStartsAFrameWhenTheOneBeforeIsDone) {
  Rig rig;
  rig.config.pace = Pace::free;
  rig.config.queue = QueueKind::dual;
  RunRecords records = rig.run(4.0, 1.0);
  std::int64_t expected_start_ns = 0;
  for (const JobRecord& job : records.jobs()) {
    if (job.kind != JobKind::cast || job.end_ns < 0) continue;
    ASSERT_EQ(job.start_ns, expected_start_ns);
    expected_start_ns = job.end_ns;
  }
  EXPECT_NEAR(static_cast<double>(rig.result.eye_frames_finished), 2.0 / 0.004, 5);  // 250 fps, not 90
  rig.config.pace = Pace::vsync;
  rig.run(4.0, 1.0);
  EXPECT_NEAR(static_cast<double>(rig.result.eye_frames_finished), 2.0 * 90, 2);
}

TEST(FrameLoop, APerfectPredictorOfAStillHeadHasNoError) {
  Rig rig({.motion = sim::Motion::stationary, .seconds = 1});
  const RunRecords records = rig.run(30.0, 1.0);
  for (const FrameRecord& r : records.frames()) {
    if (r.displayed_frame < 0) continue;
    ASSERT_LE(r.angular_error_rad, 1e-12);
    ASSERT_LE(r.position_error_m, 1e-12);
  }
}

TEST(FrameLoop, ErrorsOfATurningHeadAreRateTimesLatency) {
  // A steady 100 degrees/s about the vertical, no prediction: the rotation shown is as old as its latency.
  Rig rig({.motion = sim::Motion::spin, .degrees_per_s = 100, .seconds = 2});
  rig.predictor = &stages::predict_none;
  for (const WarpPose warp : {WarpPose::none, WarpPose::rotation}) {
    rig.config.warp_pose = warp;
    const RunRecords records = rig.run(5.0, 1.0);
    for (const FrameRecord& r : records.frames()) {
      if (r.displayed_frame < 0) continue;
      const double expected_rad =
          100 * std::numbers::pi / 180 * static_cast<double>(r.mtp_rotation_ns) * 1e-9;
      ASSERT_NEAR(r.angular_error_rad, expected_rad, 1e-9);
      ASSERT_NEAR(r.angular_error_vector_rad[1], -expected_rad, 1e-6) << "shown lags behind: about -y";
    }
  }
  rig.predictor = &stages::predict_constant_rate;
  const RunRecords predicted = rig.run(5.0, 1.0);
  for (const FrameRecord& r : predicted.frames()) {
    if (r.displayed_frame >= 3) {
      ASSERT_LE(r.angular_error_rad, 1e-9) << "a steady turn is predicted exactly";
    }
  }
}

TEST(FrameLoop, ErrorsOfAMovingHeadAreSpeedTimesLatencyUnlessTheWarpTranslates) {
  std::vector<sim::TimedPose> poses;
  for (int i = 0; i <= 2000; ++i) {
    poses.push_back(
        {sim_time(i * 1'000'000LL), {.orientation = {1, 0, 0, 0}, .position = {0.001 * i, 1.6, 0}}});
  }
  Rig rig;
  rig.trace = sim::PoseTrace("1 m/s to the right", poses);
  rig.predictor = &stages::predict_none;
  for (const WarpPose warp : {WarpPose::none, WarpPose::rotation, WarpPose::rotation_and_translation}) {
    rig.config.warp_pose = warp;
    const RunRecords records = rig.run(5.0, 1.0);
    for (const FrameRecord& r : records.frames()) {
      if (r.displayed_frame >= 0) {
        ASSERT_NEAR(r.position_error_m, static_cast<double>(r.mtp_translation_ns) * 1e-9, 1e-9);
      }
    }
  }
}

TEST(FrameLoop, AFrameIsPredictedForALaterVsyncThanTheOneWhereTheFrameBeforeItIsSeen) {
  // From the records alone: warps are always in time, so a frame done before a latch is seen at its vsync.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rig rig;
    rig.config.queue = QueueKind::dual;
    rig.config.warp_lead = ms(2);
    RandomCost cost(seed, 14, 1.9);
    RunRecords records;
    rig.run(records, cost);
    const FrameRecord* last = nullptr;
    for (const FrameRecord& r : records.frames()) {
      const bool is_new =
          r.displayed_frame >= 0 && (last == nullptr || last->displayed_frame != r.displayed_frame);
      if (is_new && last != nullptr && last->displayed_frame + 1 == r.displayed_frame) {
        ASSERT_GT(r.render_target_ns, last->photon_mid_ns)
            << "seed " << seed << " frame " << r.displayed_frame;
      }
      if (is_new) {
        last = &r;
      }
    }
  }
}

TEST(FrameLoop, TheTraceOrTheAskedForNumberEndsTheRun) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 1});
  RunRecords records = rig.run(2.0, 1.0);
  EXPECT_TRUE(rig.result.trace_ended);
  EXPECT_EQ(rig.result.vsyncs, static_cast<std::int64_t>(records.frames().size()));
  EXPECT_LE(records.frames().back().photon_mid_ns, 1'000'000'000);
  EXPECT_GT(records.frames().back().photon_mid_ns, 1'000'000'000 - 11'111'112);
  rig.config.vsyncs_max = 17;
  records = rig.run(2.0, 1.0);
  EXPECT_FALSE(rig.result.trace_ended);
  EXPECT_EQ(records.frames().size(), 17U);
}

TEST(FrameLoop, EveryJobIsRecordedOnceFinishedOrNot) {
  Rig rig;
  const RunRecords records = rig.run(100.0, 1.0);
  const std::vector<JobRecord> jobs = records.jobs_by_submission();
  EXPECT_EQ(static_cast<std::int64_t>(jobs.size()), rig.result.eye_frames_started + rig.result.warps);
  for (std::size_t i = 0; i < jobs.size(); ++i)
    ASSERT_EQ(jobs[i].job, static_cast<std::int64_t>(i));
  EXPECT_EQ(jobs.back().end_ns, -1) << "the last was under way";
}

/// Checks what the pixel side relies on: who reads and writes which slot when, and in which order calls come.
class ContractWork final : public FrameWork {
 public:
  JobOutcome update(const UpdateRequest& request) override {
    EXPECT_EQ(request.frame, last_cast_ + 1) << "an update comes right before the cast it is for";
    return {};
  }
  JobOutcome cast(const CastRequest& request) override {
    EXPECT_EQ(request.frame, last_cast_ + 1);
    EXPECT_GE(request.slot, 0);
    EXPECT_LT(request.slot, frame_slots);
    last_cast_ = slots_[request.slot] = request.frame;
    return {};
  }
  JobOutcome warp(const WarpRequest& request) override {
    EXPECT_FALSE(waiting_) << "one image between latch and vsync";
    EXPECT_EQ(slots_[request.slot], request.frame) << "the slot was cast over";
    EXPECT_GT(request.vsync_index, last_shown_);
    waiting_ = true;
    return {};
  }
  void show(const ShowRequest& request) override {
    if (last_shown_ >= 0) {
      EXPECT_EQ(request.vsync_index, last_shown_ + 1);
    }
    EXPECT_TRUE(waiting_ || !request.image_is_new);
    EXPECT_TRUE(last_shown_ >= 0 || request.image_is_new);
    if (request.image_is_new) {
      waiting_ = false;
    }
    last_shown_ = request.vsync_index;
    ++shown_;
  }

  std::int64_t shown() const { return shown_; }

 private:
  std::int64_t slots_[frame_slots] = {-1, -1};
  std::int64_t last_cast_ = -1, last_shown_ = -1, shown_ = 0;
  bool waiting_ = false;
};

TEST(FrameLoop, CallsToThePixelSideKeepTheContractUnderRandomLoads) {
  std::uint64_t seed = 0;
  for (const QueueKind queue : {QueueKind::single, QueueKind::priority, QueueKind::dual}) {
    for (const WarpPose warp : {WarpPose::none, WarpPose::rotation}) {
      for (const Pace pace : {Pace::vsync, Pace::free}) {
        Rig rig;
        ContractWork work;
        rig.work = &work;
        rig.config.queue = queue;
        rig.config.warp_pose = warp;
        rig.config.pace = pace;
        RandomCost cost(++seed, 40, 14);
        RunRecords records;
        rig.run(records, cost);
        const auto with_image = std::count_if(records.frames().begin(), records.frames().end(),
                                              [](const FrameRecord& r) { return r.displayed_frame >= 0; });
        ASSERT_EQ(work.shown(), with_image);
      }
    }
  }
}

brace_result full_then_half(void* self, const brace_control_input* input, double* quality) {
  auto* calls = static_cast<std::vector<brace_control_input>*>(self);
  calls->push_back(*input);
  *quality = calls->size() < 3 ? 1.0 : 0.5;
  return BRACE_OK;
}

TEST(FrameLoop, ControlHearsOfEveryFrameAndItsQualityReachesTheNextCast) {
  Rig rig;
  std::vector<brace_control_input> calls;
  const brace_control_functions functions{sizeof(brace_control_functions), full_then_half};
  rig.control = {&functions, &calls};
  rig.config.warp_lead = ms(2);
  CountedWork work({{.time = sim_time(0),
                     .cast = {.samples = 1000},
                     .cast_below = {{.samples = 500}},
                     .warp = {.texels = 1}}},
                   SimDuration(0), {0.5});
  rig.work = &work;
  const RunRecords records = rig.run(4.0, 1.0);
  ASSERT_EQ(static_cast<std::int64_t>(calls.size()), rig.result.eye_frames_finished);
  for (std::size_t i = 0; i < calls.size(); ++i) {
    ASSERT_EQ(calls[i].frame, i);
    ASSERT_EQ(calls[i].frame_cost_ns, 4'000'000);
    ASSERT_EQ(calls[i].budget_ns, 11'111'111 - 2'000'000);
    ASSERT_EQ(calls[i].missed, 0U);
  }
  for (const JobRecord& job : records.jobs()) {
    if (job.kind == JobKind::cast) {
      ASSERT_EQ(job.work.samples, job.index < 3 ? 1000U : 500U);
    }
  }
}

TEST(FrameLoop, WarpsDearerThanAPeriodLeaveNoBudgetButNeverANegativeOne) {
  Rig rig;
  std::vector<brace_control_input> calls;
  const brace_control_functions functions{sizeof(brace_control_functions), full_then_half};
  rig.control = {&functions, &calls};
  rig.config.queue = QueueKind::dual;
  rig.run(5.0, 40.0);
  ASSERT_GT(calls.size(), 20U);
  EXPECT_EQ(calls.back().budget_ns, 0);
}

brace_result broken_predictor(void*, const brace_tracker_sample*, std::uint32_t, std::int64_t,
                              brace_pose* pose) {
  pose->orientation_xyzw[3] = std::nan("");
  return BRACE_OK;
}

TEST(FrameLoop, AStageThatFailsEndsTheRunWithTheDeviceOrPluginCode) {
  const Rig rig;
  HeadMotion head(rig.trace, sim::Interpolation::slerp_linear, rig.tracker, 1, false, sim_time(0));
  const auto cost = make_scripted_cost({{0, 1, 1, 0}}, 1.0);
  CountedWork work({{.time = sim_time(0)}});
  RunRecords records;
  const brace_predict_functions functions{sizeof(brace_predict_functions), broken_predictor};
  try {
    run_frame_loop(rig.config, {.head = head,
                                .predict = {&functions, nullptr},
                                .control = {},
                                .cost = *cost,
                                .work = work,
                                .sink = records});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::device_or_plugin_failed);
    EXPECT_THAT(error.what(), testing::HasSubstr("predict"));
  }
}

}  // namespace
}  // namespace brace
