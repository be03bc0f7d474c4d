// schedule/chunked in the frame loop.
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

/// Eye frames of 2 * 16 cells whose samples are nanoseconds; costs cells nothing but them.
class CellWork final : public FrameWork {
 public:
  explicit CellWork(std::function<std::uint64_t(SimTime, int)> samples) : samples_(std::move(samples)) {}
  JobOutcome update(const UpdateRequest&) override { return {}; }
  JobOutcome cast(const CastRequest& request) override {
    cells_.clear();
    JobOutcome outcome;
    for (int i = 0; i < 2 * request.cell_columns * request.cell_rows; ++i) {
      cells_.push_back({{.samples = samples_(request.start, i)}});
      outcome.work.samples += cells_.back().work.samples;
    }
    outcome.cells = cells_;
    return outcome;
  }
  JobOutcome warp(const WarpRequest&) override { return {}; }

 private:
  std::function<std::uint64_t(SimTime, int)> samples_;
  std::vector<CellOutcome> cells_;
};

class SampleCost final : public CostSource {
 public:
  SimDuration cost(const CostQuery& query) override {
    return query.kind == JobKind::cast ? SimDuration(static_cast<std::int64_t>(query.work.samples))
                                       : SimDuration(1'000'000);
  }
  bool deterministic() const override { return true; }
};

ChunkedParams cells_of(int edge, ChunkedParams::Guard guard) {
  ChunkedParams params;
  params.columns = params.rows = edge;
  params.guard = guard;
  params.cell_overhead = SimDuration(0);
  return params;
}

struct Outcome {
  FrameLoopResult result;
  RunRecords records;
  std::int64_t missed = 0, missed_in_first_period = 0;
};

Outcome replay(const std::optional<ChunkedParams>& chunked,
               const std::function<std::uint64_t(SimTime, int)>& samples,
               QueueKind queue = QueueKind::single) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 6});
  rig.config.chunked = chunked;
  rig.config.pace = Pace::free;
  rig.config.queue = queue;
  CellWork cells(samples);
  CountedWork whole({{.time = sim_time(0), .cast = {.samples = 6'000'000}},
                     {.time = ms(2000 - 1) + sim_time(0), .cast = {.samples = 6'000'000}},
                     {.time = ms(2000) + sim_time(0), .cast = {.samples = 60'000'000}},
                     {.time = ms(4000 - 1) + sim_time(0), .cast = {.samples = 60'000'000}},
                     {.time = ms(4000) + sim_time(0), .cast = {.samples = 6'000'000}}});
  rig.work = chunked ? static_cast<FrameWork*>(&cells) : &whole;
  SampleCost cost;
  Outcome outcome;
  outcome.result = rig.run(outcome.records, cost);
  for (const FrameRecord& record : outcome.records.frames())
    outcome.missed += record.missed;
  return outcome;
}

/// 6 ms a frame, 60 ms between 2 and 4 s; the middle cells take more.
std::uint64_t tenfold_step(SimTime time, int cell, int cells) {
  const double s = to_s(time);
  const double ns = s >= 2.0 && s < 4.0 ? 60e6 : 6e6;
  return static_cast<std::uint64_t>(ns / cells * (cell % 2 == 0 ? 1.5 : 0.5));
}

TEST(Chunked, AfterALoadStepNoWarpIsLateAndHardlyATimeIsLost) {
  const Outcome whole = replay(std::nullopt, {});
  EXPECT_GT(whole.missed, 100);
  const Outcome clock = replay(cells_of(16, ChunkedParams::Guard::clock),
                               [](SimTime t, int cell) { return tenfold_step(t, cell, 512); });
  EXPECT_EQ(clock.missed, 0);
  EXPECT_GE(static_cast<double>(clock.result.eye_frames_finished),
            0.9 * static_cast<double>(whole.result.eye_frames_finished));
  const Outcome prediction = replay(cells_of(16, ChunkedParams::Guard::prediction),
                                    [](SimTime t, int cell) { return tenfold_step(t, cell, 512); });
  EXPECT_GT(prediction.missed, 0) << "the published scheme overruns when the load rises";
}

TEST(Chunked, ShowsEveryFrameWholeAndRecordsAllOfItsWork) {
  const Outcome outcome = replay(cells_of(4, ChunkedParams::Guard::clock),
                                 [](SimTime t, int cell) { return tenfold_step(t, cell, 32); });
  std::map<std::int64_t, std::int64_t> cost_ns, ends;
  std::int64_t last_end_ns = 0;
  for (const JobRecord& job : outcome.records.jobs()) {
    if (job.end_ns < 0) continue;
    ASSERT_GE(job.start_ns, last_end_ns) << "one GPU, one job at a time";
    last_end_ns = job.end_ns;
    if (job.kind != JobKind::cast) continue;
    cost_ns[job.index] += job.cost_ns;
    ends[job.index] += job.ends_frame;
  }
  ASSERT_GT(outcome.result.eye_frames_finished, 50);
  for (std::int64_t frame = 0; frame < outcome.result.eye_frames_finished; ++frame) {
    ASSERT_EQ(ends[frame], 1);
    ASSERT_TRUE(cost_ns[frame] == 6'000'000 || cost_ns[frame] == 60'000'000)
        << frame << ": " << cost_ns[frame];
  }
  for (const FrameRecord& record : outcome.records.frames()) {
    if (record.displayed_frame >= 0) {
      ASSERT_LE(record.render_done_ns, record.warp_start_ns);
    }
  }
}

/// Cells of a millisecond that are asked for one by one.
class OwnPoseWork final : public FrameWork {
 public:
  JobOutcome update(const UpdateRequest&) override { return {}; }
  JobOutcome cast(const CastRequest&) override {
    ADD_FAILURE() << "a frame is asked for by its cells alone";
    return {};
  }
  CellOutcome cast_cell(const CellRequest& request) override {
    asked.push_back(request);
    return {.work = {.samples = 1'000'000}};
  }
  JobOutcome warp(const WarpRequest& request) override {
    shown.push_back(request);
    return {};
  }

  std::vector<CellRequest> asked;
  std::vector<WarpRequest> shown;
};

TEST(Chunked, CellsWithPosesOfTheirOwnAreEachAskedForOnceFromTheNewestReadings) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 2});
  rig.config.chunked = cells_of(4, ChunkedParams::Guard::clock);
  rig.config.chunked->own_poses = true;
  rig.config.pace = Pace::free;
  rig.config.queue = QueueKind::single;
  rig.predictor = &stages::predict_none;
  OwnPoseWork work;
  rig.work = &work;
  SampleCost cost;
  RunRecords records;
  const FrameLoopResult result = rig.run(records, cost);
  ASSERT_GT(result.eye_frames_finished, 20);
  std::map<std::int64_t, std::vector<CellRequest>> frames;
  for (const CellRequest& request : work.asked)
    frames[request.frame.frame].push_back(request);
  for (std::int64_t frame = 0; frame < result.eye_frames_finished; ++frame) {
    const std::vector<CellRequest>& cells = frames[frame];
    ASSERT_EQ(cells.size(), 32u);
    for (int i = 0; i < 32; ++i) {
      EXPECT_EQ(cells[static_cast<std::size_t>(i)].cell, i) << "by rows";
      EXPECT_EQ(cells[static_cast<std::size_t>(i)].frame.slot, cells[0].frame.slot);
    }
    // A frame takes about three periods: the head has moved on, and each cell knows.
    EXPECT_GT(cells.back().frame.start - cells.front().frame.start, ms(30));
    EXPECT_NE(cells.back().frame.world_from_head.position, cells.front().frame.world_from_head.position);
  }
  for (const FrameRecord& record : records.frames()) {
    if (record.displayed_frame < 0) continue;
    const std::vector<CellRequest>& cells = frames[record.displayed_frame];
    EXPECT_NEAR(static_cast<double>(record.render_pose_ns), static_cast<double>(to_ns(cells[16].frame.start)),
                1e6)
        << "of the cell in the middle";
    EXPECT_EQ(record.work.samples, 32'000'000u);
  }
  for (const WarpRequest& request : work.shown)
    EXPECT_EQ(request.render_world_from_head.position,
              frames[request.frame][16].frame.world_from_head.position);
}

TEST(Chunked, CellsThatAreShownOneByOneGoWhereTheWarpLooks) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 2});
  rig.config.chunked = cells_of(4, ChunkedParams::Guard::clock);
  rig.config.chunked->own_poses = rig.config.chunked->swap_cells = true;
  rig.config.pace = Pace::free;
  rig.config.queue = QueueKind::single;
  OwnPoseWork work;
  rig.work = &work;
  SampleCost cost;
  RunRecords records;
  rig.run(records, cost);
  for (const CellRequest& request : work.asked)
    ASSERT_EQ(request.frame.slot, 0);
  // A frame takes 36 ms; what is shown is named after the middle of the newest cells, not of the last frame.
  std::int64_t ahead = 0;
  for (const FrameRecord& record : records.frames())
    ahead += record.displayed_frame >= 0 && record.render_pose_ns > record.render_done_ns;
  EXPECT_GT(ahead, 30);
}

TEST(Chunked, AtLeastOneCellIsCastPerPeriodWhateverItTakes) {
  for (const auto guard : {ChunkedParams::Guard::clock, ChunkedParams::Guard::prediction}) {
    // A cell takes 15 ms, more than a period.
    const Outcome outcome = replay(cells_of(1, guard), [](SimTime, int) { return 15'000'000; });
    EXPECT_GT(outcome.result.eye_frames_finished, 100);
  }
}

TEST(Chunked, OverrunsByNoMoreThanTheLastCellsErrorUnderAdversarialCosts) {
  std::mt19937 random(9);
  for (const auto order :
       {ChunkedParams::Order::rows, ChunkedParams::Order::cost, ChunkedParams::Order::gaze}) {
    ChunkedParams params = cells_of(8, ChunkedParams::Guard::clock);
    params.order = order;
    // From nothing to 0.4 ms, anew in every frame: no prediction holds.
    const Outcome outcome = replay(params, [&](SimTime, int) { return random() % 400'000; });
    EXPECT_EQ(outcome.missed, 0) << "the warp's margin is 0.5 ms";
    EXPECT_GT(outcome.result.eye_frames_finished, 100);
  }
}

TEST(Chunked, WorksOnEveryQueue) {
  for (const QueueKind queue : {QueueKind::single, QueueKind::priority, QueueKind::dual}) {
    const Outcome outcome = replay(
        cells_of(8, ChunkedParams::Guard::clock),
        [](SimTime t, int cell) { return tenfold_step(t, cell, 128); }, queue);
    EXPECT_EQ(outcome.missed, 0);
    EXPECT_GT(outcome.result.eye_frames_finished, 300);
  }
}

TEST(Aim, MiddleIsHalfTheExpectedLifeLater) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 3});
  rig.config.queue = QueueKind::dual;
  const RunRecords first = rig.run(25.0, 1.0);  // each eye frame is seen for three periods
  rig.config.aim = Aim::middle;
  const RunRecords middle = rig.run(25.0, 1.0);
  const FrameRecord &a = first.frames()[200], &b = middle.frames()[200];
  ASSERT_EQ(a.displayed_frame, b.displayed_frame);
  EXPECT_NEAR(static_cast<double>(b.render_target_ns - a.render_target_ns), 11.111e6, 1e5);
}

}  // namespace
}  // namespace brace
