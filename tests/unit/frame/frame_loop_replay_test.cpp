#include <chrono>
#include <cstdlib>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hmd_sim/tracker.hpp"
#include "runtime/frame/pacing_sink.hpp"
#include "runtime/timeline/costs_csv.hpp"
#include "tests/unit/frame/allocation_counter.hpp"
#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

/// Every bit of a record that counts, as text.
std::string text_of(const std::vector<FrameRecord>& records) {
  std::string text;
  for (const FrameRecord& r : records) {
    text += fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}\n",
                        r.vsync_index, r.vsync_ns, r.displayed_frame, r.missed, r.stale_run, r.render_pose_ns,
                        r.render_start_ns, r.render_done_ns, r.warp_pose_ns, r.warp_start_ns, r.warp_done_ns,
                        r.photon_first_row_ns, r.photon_mid_ns, r.photon_last_row_ns, r.mtp_rotation_ns,
                        r.mtp_translation_ns, r.frame_age_ns, r.angular_error_rad, r.position_error_m,
                        r.work.samples, r.render_target_ns, r.pose_valid, r.angular_error_vector_rad[0]);
  }
  return text;
}

sim::TrackerModel noisy_tracker() {
  return {.rate = {500, 1},
          .latency = ms(3),
          .position_noise_m = 0.001,
          .orientation_noise_rad = 0.002,
          .dropout_probability = 0.05};
}

CostModel model() {
  return {.name = "test",
          .summary = "",
          .base_ns = {.cast = 100'000, .warp = 50'000, .update = 0},
          .item_ns = {.ray = 0, .sample = 0.5, .skip_step = 0, .shading_fetch = 0, .texel = 0.1, .byte = 0}};
}

/// Casts whose work goes up and down.
CountedWork wavy_work() {
  std::vector<WorkProbe> probes;
  for (int i = 0; i <= 50; ++i) {
    probes.push_back({.time = sim_time(i * 40'000'000LL),
                      .cast = {.samples = static_cast<std::uint64_t>(5'000'000 + 4'000'000 * (i % 7))},
                      .warp = {.texels = 2'592'000}});
  }
  return CountedWork(probes);
}

/// The host at its worst: unrelated device times, pauses.
class RestlessWork final : public FrameWork {
 public:
  JobOutcome update(const UpdateRequest& request) override { return disturbed(work_.update(request)); }
  JobOutcome cast(const CastRequest& request) override { return disturbed(work_.cast(request)); }
  JobOutcome warp(const WarpRequest& request) override { return disturbed(work_.warp(request)); }
  void show(const ShowRequest& request) override { work_.show(request); }

 private:
  JobOutcome disturbed(JobOutcome outcome) {
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    outcome.device_time = SimDuration(now % 50'000'000);
    if (now % 16 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
    return outcome;
  }
  CountedWork work_ = wavy_work();
};

struct Replay {
  RunRecords records;
  FrameLoopResult result;
};

Replay replay(CostSource& cost, FrameWork& work, QueueKind queue = QueueKind::priority) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 2}, noisy_tracker());
  rig.config.queue = queue;
  rig.work = &work;
  Replay replay;
  replay.result = rig.run(replay.records, cost);
  return replay;
}

TEST(FrameLoopReplay, ModelCostsGiveIdenticalRecordsWhateverTheHostDoes) {
  for (const QueueKind queue : {QueueKind::single, QueueKind::priority, QueueKind::dual}) {
    CountedWork calm = wavy_work();
    RestlessWork restless;
    const auto first_cost = make_model_cost(model(), 1.0, 1.0),
               second_cost = make_model_cost(model(), 1.0, 1.0);
    const Replay first = replay(*first_cost, calm, queue);
    const Replay second = replay(*second_cost, restless, queue);
    EXPECT_EQ(text_of(first.records.frames()), text_of(second.records.frames()));
    EXPECT_EQ(first.records.jobs(), second.records.jobs());
    EXPECT_EQ(first.result.events, second.result.events);
  }
}

TEST(FrameLoopReplay, AnotherSeedChangesThePosesAndNotThePacing) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 1}, noisy_tracker());
  const RunRecords one = rig.run(12.0, 1.0);
  rig.seed = 2;
  const RunRecords two = rig.run(12.0, 1.0);
  EXPECT_NE(text_of(one.frames()), text_of(two.frames()));
  for (std::size_t i = 0; i < one.frames().size(); ++i) {
    ASSERT_EQ(one.frames()[i].warp_done_ns, two.frames()[i].warp_done_ns);
  }
}

TEST(FrameLoopReplay, RecordedCostsReproduceTheTimelineOfARunMeasuredOnARealClock) {
  for (const QueueKind queue : {QueueKind::single, QueueKind::priority, QueueKind::dual}) {
    RestlessWork work;
    const auto measured = make_measured_cost(1.0);
    const Replay original = replay(*measured, work, queue);
    const std::vector<JobRecord> jobs = original.records.jobs_by_submission();

    const auto recorded = make_recorded_cost(jobs, "the original", 1.0);
    CountedWork counted = wavy_work();
    const Replay again = replay(*recorded, counted, queue);
    EXPECT_EQ(text_of(original.records.frames()), text_of(again.records.frames()));
    EXPECT_EQ(to_costs_csv(jobs), to_costs_csv(again.records.jobs_by_submission()));
  }
}

TEST(FrameLoopReplay, StreamedFiguresEqualThoseOfTheRecords) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 20}, noisy_tracker());
  RandomCost first_cost(3, 30, 3), second_cost(3, 30, 3);
  RunRecords records;
  PacingSink stream;
  rig.run(records, first_cost);
  rig.run(stream, second_cost);
  const PacingFigures exact = pacing_figures(records.frames()), streamed = stream.figures();
  EXPECT_EQ(streamed.vsyncs, exact.vsyncs);
  EXPECT_EQ(streamed.missed_vsyncs, exact.missed_vsyncs);
  EXPECT_EQ(streamed.longest_stale_run, exact.longest_stale_run);
  EXPECT_EQ(streamed.judder_rms_deg, exact.judder_rms_deg);
  EXPECT_EQ(stream.jobs(), static_cast<std::int64_t>(records.jobs().size()));
  for (const auto& distribution : {&PacingFigures::mtp_rotation_ms, &PacingFigures::mtp_translation_ms,
                                   &PacingFigures::frame_age_ms, &PacingFigures::angular_error_deg,
                                   &PacingFigures::position_error_mm, &PacingFigures::animation_error_ms}) {
    const Distribution& e = exact.*distribution;
    const Distribution& s = streamed.*distribution;
    EXPECT_EQ(s.count, e.count);
    EXPECT_EQ(s.max, e.max);
    for (const auto value : {&Distribution::p50, &Distribution::p95, &Distribution::p99}) {
      EXPECT_NEAR(s.*value, e.*value, 5e-4 * e.*value + 1e-12);
    }
    EXPECT_NEAR(s.mean, e.mean, 1e-9 * e.mean);
  }
}

/// Notes what has been counted at the end of every part of a run.
class PartsSink final : public RecordSink {
 public:
  explicit PartsSink(std::int64_t part_vsyncs) : part_vsyncs_(part_vsyncs) {
    allocations_.reserve(2000);
    jobs_.reserve(2000);
  }
  void add(const FrameRecord& record) override {
    pacing_.add(record);
    if ((record.vsync_index + 1) % part_vsyncs_ == 0) {
      allocations_.push_back(allocation_count());
      jobs_.push_back(pacing_.jobs());
    }
  }
  void add(const JobRecord& record) override { pacing_.add(record); }

  std::vector<std::uint64_t> allocations_;
  std::vector<std::int64_t> jobs_;
  PacingSink pacing_;

 private:
  std::int64_t part_vsyncs_;
};

/// Six simulated minutes; 24 hours with BRACE_LONG_TESTS set.
std::int64_t long_run_vsyncs() {
  return 90 * 360 * (std::getenv("BRACE_LONG_TESTS") != nullptr ? 240 : 1);
}

TEST(FrameLoopReplay, LongRunsAllocateNothingAndDoTheSameWorkPerVsyncToTheEnd) {
  for (const QueueKind queue : {QueueKind::single, QueueKind::priority}) {
    Rig rig({.motion = sim::Motion::natural, .seconds = 60, .rate = {100, 1}},
            {.rate = {1000, 1}, .latency = ms(2)});
    rig.loop = true;
    rig.config.queue = queue;
    rig.config.vsyncs_max = long_run_vsyncs();
    CountedWork work({{.time = sim_time(0), .cast = {.samples = 9'000'000}, .warp = {.texels = 2'592'000}}});
    rig.work = &work;
    const auto cost = make_model_cost(model(), 1.0, 1.0);
    const std::int64_t part = 5400;  // the trace's minute: every part sees the same motion
    PartsSink sink(part);
    const FrameLoopResult result = rig.run(sink, *cost);

    EXPECT_EQ(result.vsyncs, long_run_vsyncs());
    EXPECT_EQ(result.duplicate_predictions, 0);
    EXPECT_EQ(result.revised_predictions, 0);
    EXPECT_EQ(sink.pacing_.figures().missed_vsyncs, 0);
    for (std::size_t i = 1; i < sink.allocations_.size(); ++i) {
      ASSERT_EQ(sink.allocations_[i], sink.allocations_[0]) << "part " << i << " allocated";
      ASSERT_EQ(sink.jobs_[i] - sink.jobs_[i - 1], 2 * part) << "one cast and one warp per vsync";
    }
    // Four events per vsync: vsync, latch, two ends. The first vsync has no warp.
    EXPECT_NEAR(static_cast<double>(result.events), 4.0 * static_cast<double>(result.vsyncs), 4);
  }
}

TEST(FrameLoopReplay, TheAllocationCounterCounts) {
  const std::uint64_t before = allocation_count();
  const auto memory = std::make_unique<std::vector<int>>(100);
  EXPECT_EQ(allocation_count(), before + 2);
  EXPECT_EQ(memory->size(), 100U);
}

}  // namespace
}  // namespace brace
