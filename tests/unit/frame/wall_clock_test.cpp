// The frame loop by a clock that goes on by itself.

#include <gtest/gtest.h>

#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

/// Time goes on when the loop waits, and by what work takes.
class ToldClock final : public WallClock {
 public:
  SimTime now() const override { return now_; }
  void wait_until(SimTime time) override { now_ = std::max(now_, time); }
  void take(SimDuration duration) { now_ += duration; }

 private:
  SimTime now_{};
};

class TimedWork final : public FrameWork {
 public:
  TimedWork(ToldClock& clock, SimDuration cast, SimDuration warp) : clock_(clock), cast_(cast), warp_(warp) {}
  JobOutcome update(const UpdateRequest&) override { return {}; }
  JobOutcome cast(const CastRequest&) override {
    clock_.take(cast_);
    return {.work = {.samples = 1}};
  }
  CellOutcome cast_cell(const CellRequest& request) override {
    clock_.take(cast_ / (2 * request.frame.cell_columns * request.frame.cell_rows));
    poses.push_back(request.frame.world_from_head.position);
    return {.work = {.samples = 1}};
  }
  JobOutcome warp(const WarpRequest&) override {
    clock_.take(warp_);
    return {};
  }

  std::vector<glm::dvec3> poses;  // of cells

 private:
  ToldClock& clock_;
  SimDuration cast_, warp_;
};

/// Not asked by a wall clock.
class NoCost final : public CostSource {
 public:
  SimDuration cost(const CostQuery&) override {
    ADD_FAILURE();
    return SimDuration(0);
  }
  bool deterministic() const override { return false; }
};

struct Outcome {
  FrameLoopResult result;
  RunRecords records;
  std::vector<glm::dvec3> cell_poses;
  std::int64_t missed = 0;
};

Outcome replay(double cast_ms, double warp_ms, const std::optional<ChunkedParams>& chunked,
               Pace pace = Pace::free) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 3});
  rig.config.chunked = chunked;
  rig.config.pace = pace;
  rig.config.queue = QueueKind::single;
  ToldClock clock;
  rig.wall = &clock;
  TimedWork work(clock, ms(cast_ms), ms(warp_ms));
  rig.work = &work;
  NoCost cost;
  Outcome outcome;
  outcome.result = rig.run(outcome.records, cost);
  outcome.cell_poses = work.poses;
  for (const FrameRecord& record : outcome.records.frames())
    outcome.missed += record.missed;
  return outcome;
}

TEST(WallClock, LightFramesAreShownAtEveryVsync) {
  const Outcome outcome = replay(4.0, 1.0, std::nullopt, Pace::vsync);
  EXPECT_GT(outcome.result.vsyncs, 260);
  EXPECT_EQ(outcome.missed, 0);
  for (const JobRecord& job : outcome.records.jobs()) {
    if (job.end_ns < 0) continue;
    EXPECT_EQ(job.cost_ns, job.kind == JobKind::cast ? 4'000'000 : 1'000'000) << "what it took";
  }
}

TEST(WallClock, WhatTakesLongMakesVsyncsMissAndTheirTimesStay) {
  const Outcome outcome = replay(30.0, 1.0, std::nullopt);
  EXPECT_GT(outcome.missed, outcome.result.vsyncs / 2);
  EXPECT_GT(outcome.result.warps, outcome.result.vsyncs / 4) << "late ones are shown all the same";
  std::int64_t last = -1;
  for (const FrameRecord& record : outcome.records.frames()) {
    EXPECT_EQ(record.vsync_index, ++last);
    EXPECT_NEAR(static_cast<double>(record.vsync_ns), 1e9 / 90 * static_cast<double>(last), 1.0);
    if (record.displayed_frame < 0) continue;
    EXPECT_LE(record.warp_done_ns, record.vsync_ns) << "an image done after the vsync is not seen at it";
  }
}

TEST(WallClock, ARunDoesNotFallBehindItsClock) {
  for (const Pace pace : {Pace::free, Pace::vsync}) {
    const Outcome outcome = replay(15.0, 2.0, std::nullopt, pace);
    EXPECT_GT(outcome.result.warps, outcome.result.vsyncs / 3);
    const FrameRecord& last = outcome.records.frames().back();
    EXPECT_LT(last.vsync_ns - last.warp_done_ns, 40'000'000) << "what is shown is not old";
    EXPECT_LT(last.vsync_ns - last.render_start_ns, 60'000'000);
  }
}

TEST(WallClock, FramesInCellsLeaveTheWarpItsTime) {
  ChunkedParams params;
  params.columns = params.rows = 4;
  const Outcome outcome = replay(30.0, 1.0, params);
  EXPECT_EQ(outcome.missed, 0);
  EXPECT_GT(outcome.result.eye_frames_finished, 50);
  ASSERT_GT(outcome.cell_poses.size(), 64u);
  for (std::size_t i = 0; i < 64; ++i)
    EXPECT_EQ(outcome.cell_poses[i], outcome.cell_poses[i / 32 * 32]) << "from the pose of their frame";
  params.own_poses = true;
  const Outcome own = replay(30.0, 1.0, params);
  EXPECT_EQ(own.missed, 0);
  EXPECT_NE(own.cell_poses[63], own.cell_poses[32]);
}

}  // namespace
}  // namespace brace
