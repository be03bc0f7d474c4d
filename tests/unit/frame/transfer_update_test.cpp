// A transfer function that changes while frames are shown: when its update jobs come, what they cost the
// frames around them, and what they leave alone.
#include <gtest/gtest.h>

#include "tests/unit/frame/allocation_counter.hpp"
#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

std::vector<JobRecord> jobs_of(const RunRecords& records, JobKind kind) {
  std::vector<JobRecord> jobs;
  for (const JobRecord& job : records.jobs_by_submission())
    if (job.kind == kind) jobs.push_back(job);
  return jobs;
}

TEST(TransferUpdates, AVersionIsInForceFromItsChangeOn) {
  const TransferSchedule never;
  EXPECT_EQ(never.version_at(sim_time(1'000'000'000'000)), 0);
  const TransferSchedule list({sim_time(10), sim_time(20)});
  for (const auto& [ns, version] : {std::pair(-5, 0), {0, 0}, {9, 0}, {10, 1}, {19, 1}, {20, 2}, {1'000, 2}})
    EXPECT_EQ(list.version_at(sim_time(ns)), version) << ns;
  const TransferSchedule vsyncs = TransferSchedule::at_every_vsync({90, 1});
  EXPECT_EQ(vsyncs.version_at(sim_time(0)), 0);
  EXPECT_EQ(vsyncs.version_at(sim_time(vsync_ns(7))), 7);
  EXPECT_EQ(vsyncs.version_at(sim_time(vsync_ns(7) - 1)), 6);
}

TEST(TransferUpdates, OneChangeIsOneJobRightBeforeTheFirstCastThatShowsIt) {
  Rig rig;
  rig.config.vsyncs_max = 60;
  rig.config.transfer = TransferSchedule({sim_time(vsync_ns(20) + 1)});  // just after frame 20's start
  const RunRecords records = rig.run({{0, 3.0, 1.0, 0.5}});
  const auto updates = jobs_of(records, JobKind::update);
  ASSERT_EQ(updates.size(), 1U);
  EXPECT_EQ(rig.result.transfer_updates, 1);
  EXPECT_EQ(updates[0].index, 21);
  EXPECT_EQ(updates[0].submit_ns, vsync_ns(21));
  const auto casts = jobs_of(records, JobKind::cast);
  EXPECT_EQ(casts[21].job, updates[0].job + 1);
  EXPECT_EQ(casts[21].start_ns, updates[0].end_ns);
  EXPECT_EQ(casts[20].start_ns, casts[20].submit_ns);
  EXPECT_EQ(casts[22].start_ns, casts[22].submit_ns);
}

TEST(TransferUpdates, VersionsThatNoFrameStartsInArePassedOver) {
  Rig rig;
  rig.config.vsyncs_max = 60;
  rig.config.transfer =
      TransferSchedule({sim_time(vsync_ns(3) + 1), sim_time(vsync_ns(3) + 2), sim_time(vsync_ns(3) + 3)});
  const RunRecords records = rig.run({{0, 3.0, 1.0, 0.5}});
  EXPECT_EQ(jobs_of(records, JobKind::update).size(), 1U);
}

/// What is asked of the pixels, kept in order.
class WatchedWork final : public FrameWork {
 public:
  JobOutcome update(const UpdateRequest& request) override {
    EXPECT_GT(request.transfer_version, casting_);
    casting_ = request.transfer_version;
    return {};
  }
  JobOutcome cast(const CastRequest& request) override {
    slots_[request.slot] = casting_;
    EXPECT_EQ(casting_, schedule_.version_at(request.start));
    return {};
  }
  JobOutcome warp(const WarpRequest&) override { return {}; }
  void show(const ShowRequest& request) override {
    const SimTime mid = sim_time(vsync_ns(request.vsync_index)) + ms(1000.0 / 180);
    EXPECT_NEAR(static_cast<double>(request.transfer_version), static_cast<double>(schedule_.version_at(mid)),
                0.0)
        << "the ideal picture has the transfer function of photon time";
    ++shown_;
  }
  TransferSchedule schedule_;
  std::int64_t shown_ = 0;

 private:
  std::int64_t casting_ = 0;
  std::int64_t slots_[frame_slots] = {};
};

TEST(TransferUpdates, CastsShowTheVersionOfTheirStartAndIdealPicturesThatOfTheirPhotons) {
  for (const bool list : {true, false}) {
    Rig rig;
    rig.config.vsyncs_max = 90;
    WatchedWork work;
    work.schedule_ = list ? TransferSchedule({sim_time(vsync_ns(30)), sim_time(vsync_ns(50) + 4'000'000)})
                          : TransferSchedule::at_every_vsync({90, 1});
    rig.work = &work;
    rig.config.transfer = work.schedule_;
    rig.run({{0, 3.0, 1.0, 0.5}});
    EXPECT_GT(work.shown_, 80);
  }
}

/// Keeps no records, so that what is allocated is the loop's; notes casts that take other than expected.
class HitchSink final : public RecordSink {
 public:
  void add(const FrameRecord& record) override {
    missed_ += record.missed ? 1 : 0;
    if (record.vsync_index == 100) allocations_at_100_ = allocation_count();
    allocations_ = allocation_count();
  }
  void add(const JobRecord& job) override {
    if (job.kind == JobKind::update) ++updates_;
    if (job.kind != JobKind::cast || job.end_ns < 0) return;
    ++casts_;
    longest_ns_ = std::max(longest_ns_, job.end_ns - job.submit_ns);
  }
  std::int64_t missed_ = 0, updates_ = 0, casts_ = 0, longest_ns_ = 0;
  std::uint64_t allocations_at_100_ = 0, allocations_ = 0;
};

TEST(TransferUpdates, AChangeAtEachOfAThousandFramesCostsItsOwnWorkAndNothingElse) {
  for (const QueueKind queue : {QueueKind::single, QueueKind::priority, QueueKind::dual}) {
    Rig rig({.motion = sim::Motion::natural, .seconds = 12});
    rig.config.queue = queue;
    rig.config.vsyncs_max = 1000;
    CountedWork work({{.time = sim_time(0),
                       .cast = {.samples = 2'000'000},
                       .warp = {.texels = 1'000'000},
                       .update = {.bytes = 1'500'000}}});
    rig.work = &work;
    CostModel model;
    model.item_ns = {.sample = 1.0, .texel = 1.0, .byte = 1.0};
    HitchSink without, with;
    rig.run(without, *make_model_cost(model, 16.0, 1.0 / 16));
    rig.config.transfer = TransferSchedule::at_every_vsync({90, 1});
    const FrameLoopResult result = rig.run(with, *make_model_cost(model, 16.0, 1.0 / 16));
    EXPECT_EQ(result.transfer_updates, with.casts_ - 1) << "frame 0 shows version 0";
    EXPECT_GE(with.updates_, 998);
    EXPECT_EQ(with.casts_, without.casts_);
    EXPECT_EQ(with.missed_, without.missed_);
    EXPECT_EQ(with.missed_, 0);
    // 16 times the pixels at a sixteenth of the price each; bytes are of the volume and are not multiplied.
    EXPECT_EQ(without.longest_ns_, 2'000'000);
    EXPECT_EQ(with.longest_ns_, 2'000'000 + 1'500'000 / 16);
    EXPECT_EQ(with.allocations_, with.allocations_at_100_) << "the loop allocated";
  }
}

}  // namespace
}  // namespace brace
