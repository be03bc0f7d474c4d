// schedule/chunked under load control: a frame that is far too late is given up, and a cheaper one is cast.
#include <array>
#include <map>

#include <gtest/gtest.h>

#include "stages/control/control.hpp"
#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

/// Frames that cost `ns(time)` at quality 1, spread evenly over their cells.
class ScaledWork final : public FrameWork {
 public:
  explicit ScaledWork(std::function<double(double)> ns) : ns_(std::move(ns)) {}
  JobOutcome update(const UpdateRequest&) override { return {}; }
  JobOutcome cast(const CastRequest& request) override {
    frame_in_slot_.at(static_cast<std::size_t>(request.slot)) = request.frame;
    qualities.push_back(request.quality);
    return {.work = {.samples = static_cast<std::uint64_t>(ns_(to_s(request.start)) * request.quality)}};
  }
  JobOutcome warp(const WarpRequest& request) override {
    overwritten += frame_in_slot_.at(static_cast<std::size_t>(request.slot)) != request.frame;
    return {};
  }

  std::vector<double> qualities;  // of every frame started
  int overwritten = 0;            // warps of a slot that another frame was cast into since

 private:
  std::function<double(double)> ns_;
  std::array<std::int64_t, frame_slots> frame_in_slot_{-1, -1};
};

/// A sample is a nanosecond; a warp takes 0.5 ms.
class NsCost final : public CostSource {
 public:
  SimDuration cost(const CostQuery& query) override {
    return query.kind == JobKind::cast ? SimDuration(static_cast<std::int64_t>(query.work.samples)) : ms(0.5);
  }
  bool deterministic() const override { return true; }
};

struct Replayed {
  FrameLoopResult result;
  RunRecords records;
  ScaledWork work;
  int missed = 0, longest_repeats = 0, repeats = 0;  // of vsyncs that show an eye frame again
};

Replayed replay_step(int give_up_periods, const std::function<double(double)>& ns,
                     const brace_stage_descriptor& controller = stages::control_quantile) {
  Rig rig({.motion = sim::Motion::natural, .seconds = 33});
  const Stage control(controller);
  Replayed done{{}, {}, ScaledWork(ns)};
  rig.control = control.control();
  rig.work = &done.work;
  rig.config.chunked = ChunkedParams{.cell_overhead = SimDuration(0), .give_up_periods = give_up_periods};
  rig.config.vsyncs_max = 3000;
  NsCost cost;
  done.result = rig.run(done.records, cost);
  std::int64_t shown = -1;
  int again = 0;
  for (const FrameRecord& record : done.records.frames()) {
    done.missed += record.missed;
    again = record.displayed_frame == shown ? again + 1 : 0;
    if (record.displayed_frame < 0) again = 0;
    shown = record.displayed_frame;
    done.repeats += again > 0;
    done.longest_repeats = std::max(done.longest_repeats, again);
  }
  return done;
}

/// Half of a period, ten times as much in the middle third.
double tenfold(double s) {
  return (s >= 1000.0 / 90.0 && s < 2000.0 / 90.0 ? 10.0 : 1.0) * 4.5e6;
}

TEST(GiveUp, AfterATenfoldLoadStepNoEyeFrameIsSeenForMoreThanFourPeriods) {
  const Replayed waits = replay_step(0, tenfold), gives_up = replay_step(1, tenfold);
  EXPECT_EQ(waits.result.eye_frames_given_up, 0);
  EXPECT_GE(waits.longest_repeats, 4) << "45 ms have to be cast";
  EXPECT_GE(gives_up.result.eye_frames_given_up, 1);
  EXPECT_LE(gives_up.longest_repeats, 3);
  EXPECT_LE(gives_up.repeats, 0.006 * 3000);
  EXPECT_EQ(gives_up.missed, 0) << "warps are on time in either case";
  EXPECT_EQ(gives_up.result.eye_frames_started - gives_up.result.eye_frames_given_up -
                    gives_up.result.eye_frames_finished <=
                1,
            true);
}

TEST(GiveUp, WhatIsGivenUpIsNeverShownAndTheFrameInFrontStaysWhole) {
  // control/pi goes up again soon, so that every rise of the load finds a frame of many rays.
  const auto load = [](double s) { return (std::fmod(s, 1.4) < 0.7 ? 3.0 : 60.0) * 1e6; };
  const Replayed done = replay_step(1, load, stages::control_pi);
  EXPECT_GT(done.result.eye_frames_given_up, 10);
  EXPECT_EQ(done.work.overwritten, 0);
  std::map<std::int64_t, int> ends;
  for (const JobRecord& job : done.records.jobs())
    if (job.kind == JobKind::cast && job.end_ns >= 0) ends[job.index] += job.ends_frame;
  std::int64_t without_end = 0;
  for (const auto& [frame, count] : ends)
    without_end += count == 0;
  EXPECT_GE(without_end, done.result.eye_frames_given_up);
  for (const FrameRecord& record : done.records.frames()) {
    if (record.displayed_frame >= 0) {
      ASSERT_EQ(ends[record.displayed_frame], 1) << record.displayed_frame;
    }
  }
}

TEST(GiveUp, AFrameIsFinishedWhereLoadControlDoesNotCut) {
  // control/fixed never asks for fewer rays: giving up would never end.
  const Replayed done = replay_step(
      1, [](double) { return 60e6; }, stages::control_fixed);
  EXPECT_EQ(done.result.eye_frames_given_up, 0);
  EXPECT_GT(done.result.eye_frames_finished, 400);
  EXPECT_EQ(done.missed, 0);
}

}  // namespace
}  // namespace brace
