#include "runtime/timeline/simulated_gpu.hpp"

#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>

namespace brace {
namespace {

constexpr SimDuration us(std::int64_t count) {
  return SimDuration(count * 1000);
}
constexpr SimTime at_us(std::int64_t count) {
  return sim_time(count * 1000);
}

struct Submission {
  SimTime time;
  GpuJob job;
};

/// Runs submissions (in order of time) to their end and gives the records by job. `extra` more advances at
/// arbitrary times must not matter.
std::vector<JobRecord> run(QueueKind kind, const PreemptionParams& preemption,
                           const std::vector<Submission>& submissions, unsigned extra = 0) {
  SimulatedGpu gpu(kind, preemption);
  std::mt19937_64 random(extra);
  std::vector<JobRecord> records;
  const auto collect = [&] {
    while (const std::optional<JobRecord> record = gpu.take_finished())
      records.push_back(*record);
  };
  const auto advance_to = [&](SimTime time) {
    while (gpu.next_change() && *gpu.next_change() <= time)
      gpu.advance(*gpu.next_change());
    collect();
  };
  SimTime now = at_us(0);
  for (const Submission& submission : submissions) {
    for (unsigned i = 0; i < extra && submission.time > now; ++i) {
      now += SimDuration(static_cast<std::int64_t>(random() % 1000) * (submission.time - now).count() / 1000);
      gpu.advance(now);
      collect();
    }
    advance_to(submission.time);
    now = submission.time;
    gpu.submit(submission.job, now);
  }
  advance_to(SimTime::max());
  EXPECT_TRUE(gpu.unfinished().empty());
  EXPECT_TRUE(std::is_sorted(records.begin(), records.end(),
                             [](const JobRecord& a, const JobRecord& b) { return a.end_ns < b.end_ns; }));
  std::sort(records.begin(), records.end(),
            [](const JobRecord& a, const JobRecord& b) { return a.job < b.job; });
  return records;
}

GpuJob cast(std::int64_t index, SimDuration cost) {
  return {JobKind::cast, index, cost, {}};
}
GpuJob warp(std::int64_t index, SimDuration cost) {
  return {JobKind::warp, index, cost, {}};
}

constexpr PreemptionParams usual{us(100), us(50)};

TEST(SimulatedGpu, SingleQueueMakesAWarpWaitForTheCastBeforeIt) {
  const auto r =
      run(QueueKind::single, usual, {{at_us(0), cast(0, us(10'000))}, {at_us(4'000), warp(1, us(1'000))}});
  EXPECT_EQ(r[0].start_ns, 0);
  EXPECT_EQ(r[0].end_ns, 10'000'000);
  EXPECT_EQ(r[1].submit_ns, 4'000'000);
  EXPECT_EQ(r[1].start_ns, 10'000'000);
  EXPECT_EQ(r[1].end_ns, 11'000'000);
  EXPECT_EQ(r[0].preempted_ns, 0);
}

TEST(SimulatedGpu, DualQueuesDoNotTouchEachOther) {
  const auto r =
      run(QueueKind::dual, usual, {{at_us(0), cast(0, us(10'000))}, {at_us(4'000), warp(1, us(1'000))}});
  EXPECT_EQ(r[0].end_ns, 10'000'000);
  EXPECT_EQ(r[1].start_ns, 4'000'000);
  EXPECT_EQ(r[1].end_ns, 5'000'000);
}

TEST(SimulatedGpu, PriorityPreemptsAtTheNextGrainAndPaysTwoSwitches) {
  const auto r =
      run(QueueKind::priority, usual, {{at_us(0), cast(0, us(10'000))}, {at_us(4'030), warp(1, us(1'000))}});
  EXPECT_EQ(r[1].start_ns, 4'150'000);  // grain at 4.1 ms, switch 0.05 ms
  EXPECT_EQ(r[1].end_ns, 5'150'000);
  EXPECT_EQ(r[0].preempted_ns, 1'100'000);  // warp and two switches
  EXPECT_EQ(r[0].end_ns, 11'100'000);
}

TEST(SimulatedGpu, GrainsCountTheJobsOwnWorkAcrossPreemptions) {
  // After the first preemption (4.1 ms of work done) the cast resumes at 5.2 ms; at 5.25 ms 4.15 ms are done,
  // so the next grain is 4.2 ms of work, at 5.3 ms.
  const auto r = run(QueueKind::priority, usual,
                     {{at_us(0), cast(0, us(10'000))},
                      {at_us(4'030), warp(1, us(1'000))},
                      {at_us(5'250), warp(2, us(1'000))}});
  EXPECT_EQ(r[2].start_ns, 5'350'000);
}

TEST(SimulatedGpu, ACastThatEndsBeforeItsNextGrainIsNotPreempted) {
  const auto r = run(QueueKind::priority, {us(1'000), us(50)},
                     {{at_us(0), cast(0, us(950))}, {at_us(10), warp(1, us(100))}});
  EXPECT_EQ(r[0].end_ns, 950'000);
  EXPECT_EQ(r[0].preempted_ns, 0);
  EXPECT_EQ(r[1].start_ns, 950'000);  // and no switch is paid
}

TEST(SimulatedGpu, WarpsInARowPayOneSwitchOutAndOneIn) {
  const auto r = run(
      QueueKind::priority, {us(0), us(50)},
      {{at_us(0), cast(0, us(10'000))}, {at_us(1'000), warp(1, us(500))}, {at_us(1'100), warp(2, us(500))}});
  EXPECT_EQ(r[1].start_ns, 1'050'000);
  EXPECT_EQ(r[2].start_ns, 1'550'000);
  EXPECT_EQ(r[0].preempted_ns, 1'100'000);
}

TEST(SimulatedGpu, AWarpThatComesWhileTheCastIsTakenUpAgainWaitsForTheSwitchAndPaysItsOwn) {
  const auto r = run(
      QueueKind::priority, {us(0), us(50)},
      {{at_us(0), cast(0, us(10'000))}, {at_us(1'000), warp(1, us(500))}, {at_us(1'560), warp(2, us(500))}});
  // warp 1: 1.05 … 1.55, switch in until 1.60, switch out until 1.65
  EXPECT_EQ(r[2].start_ns, 1'650'000);
  EXPECT_EQ(r[0].end_ns, 10'000'000 + 2 * 500'000 + 4 * 50'000);
}

TEST(SimulatedGpu, FreeJobsEndWhenTheyAreSubmitted) {
  for (const QueueKind kind : {QueueKind::single, QueueKind::priority, QueueKind::dual}) {
    SimulatedGpu gpu(kind, usual);
    gpu.submit(cast(0, us(0)), at_us(7));
    ASSERT_EQ(gpu.next_change(), at_us(7));
    gpu.advance(at_us(7));
    const std::optional<JobRecord> record = gpu.take_finished();
    ASSERT_TRUE(record);
    EXPECT_EQ(record->start_ns, 7'000);
    EXPECT_EQ(record->end_ns, 7'000);
  }
}

TEST(SimulatedGpu, UnfinishedJobsAreToldApartByTheirStart) {
  SimulatedGpu gpu(QueueKind::single, usual);
  gpu.submit(cast(0, us(10)), at_us(0));
  gpu.submit(cast(1, us(10)), at_us(1));
  gpu.advance(at_us(5));
  const std::vector<JobRecord> left = gpu.unfinished();
  ASSERT_EQ(left.size(), 2U);
  EXPECT_EQ(left[0].start_ns, 0);
  EXPECT_EQ(left[0].end_ns, -1);
  EXPECT_EQ(left[1].start_ns, -1);
  EXPECT_EQ(left[1].cost_ns, 10'000);
}

std::vector<Submission> random_load(std::mt19937_64& random, std::size_t count) {
  std::vector<Submission> submissions;
  std::int64_t time_ns = 0;
  for (std::size_t i = 0; i < count; ++i) {
    time_ns += static_cast<std::int64_t>(random() % 400);
    const bool is_warp = random() % 3 == 0;
    const SimDuration cost(static_cast<std::int64_t>(random() % (is_warp ? 60 : 500)));
    submissions.push_back(
        {sim_time(time_ns),
         {is_warp ? JobKind::warp : JobKind::cast, static_cast<std::int64_t>(i), cost, {}}});
  }
  return submissions;
}

TEST(SimulatedGpu, ConservesWorkInRandomLoads) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 200; ++round) {
    const std::vector<Submission> load = random_load(random, 60);
    const PreemptionParams preemption{SimDuration(static_cast<std::int64_t>(random() % 40)),
                                      SimDuration(static_cast<std::int64_t>(random() % 10))};
    for (const QueueKind kind : {QueueKind::single, QueueKind::priority, QueueKind::dual}) {
      const std::vector<JobRecord> records = run(kind, preemption, load);
      ASSERT_EQ(records.size(), load.size());
      std::map<JobKind, std::int64_t> last_end;
      std::int64_t warp_cost_ns = 0, preempted_ns = 0;
      for (const JobRecord& r : records) {
        ASSERT_GE(r.start_ns, r.submit_ns);
        ASSERT_GE(r.preempted_ns, 0);
        ASSERT_EQ(r.end_ns - r.start_ns, r.cost_ns + r.preempted_ns);
        ASSERT_GE(r.start_ns, last_end[r.kind]) << "a kind's jobs run in order";
        last_end[r.kind] = r.end_ns;
        if (r.kind == JobKind::warp) {
          warp_cost_ns += r.cost_ns;
          ASSERT_EQ(r.preempted_ns, 0);
        } else {
          preempted_ns += r.preempted_ns;
        }
      }
      if (kind != QueueKind::priority) {
        ASSERT_EQ(preempted_ns, 0);
      } else if (preemption.switch_cost == SimDuration(0)) {
        ASSERT_LE(preempted_ns, warp_cost_ns);
      }
    }
  }
}

TEST(SimulatedGpu, WhenAndHowOftenItIsAskedDoesNotMatter) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 100; ++round) {
    const std::vector<Submission> load = random_load(random, 40);
    const PreemptionParams preemption{SimDuration(17), SimDuration(5)};
    for (const QueueKind kind : {QueueKind::single, QueueKind::priority, QueueKind::dual}) {
      ASSERT_EQ(run(kind, preemption, load), run(kind, preemption, load, 4));
    }
  }
}

TEST(SimulatedGpu, PriorityWithoutGrainOrSwitchCostRunsWarpsAsIfAlone) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 100; ++round) {
    const std::vector<Submission> load = random_load(random, 40);
    std::vector<Submission> warps_alone;
    std::copy_if(load.begin(), load.end(), std::back_inserter(warps_alone),
                 [](const Submission& s) { return s.job.kind == JobKind::warp; });
    const std::vector<JobRecord> all = run(QueueKind::priority, {us(0), us(0)}, load);
    const std::vector<JobRecord> alone = run(QueueKind::single, {us(0), us(0)}, warps_alone);
    std::size_t next = 0;
    for (const JobRecord& record : all) {
      if (record.kind != JobKind::warp) continue;
      ASSERT_EQ(record.start_ns, alone[next].start_ns);
      ASSERT_EQ(record.end_ns, alone[next].end_ns);
      ++next;
    }
  }
}

}  // namespace
}  // namespace brace
