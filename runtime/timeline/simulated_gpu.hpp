#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/time.hpp"
#include "runtime/timeline/job_record.hpp"

namespace brace {

enum class QueueKind {
  single,    // one queue in order, no preemption: a warp waits for the ray casting before it (thesis, 5.1)
  priority,  // a warp queue that preempts the ray-casting queue
  dual       // warps on a GPU of their own (Smit et al.'s programmable display layer)
};

/// Defaults are assumptions: GPU makers state "below 100 us" for pixel-level and compute preemption since
/// 2016 (Pascal), and nothing finer. Only `priority` reads them.
struct PreemptionParams {
  /// A running job can be left only at multiples of this much of its own work.
  SimDuration granularity{100'000};
  /// GPU time lost each time a preempted job is left and again when it is taken up.
  SimDuration switch_cost{50'000};
};

struct GpuJob {
  JobKind kind = JobKind::cast;
  std::int64_t index = 0;
  SimDuration cost{0};
  WorkCounts work{};
};

/// Executes jobs in simulated time. It owns no clock: the caller tells it the time with every call, in
/// non-decreasing order, and must advance() to every next_change() for ends to be known in time.
class SimulatedGpu {
 public:
  SimulatedGpu(QueueKind kind, const PreemptionParams& preemption);

  /// Queues a job at `now`; returns its number.
  std::int64_t submit(const GpuJob& job, SimTime now);

  /// The next time at which the state changes by itself, if anything runs. A submission may make it earlier.
  std::optional<SimTime> next_change() const;

  /// Executes up to and including `now`. Idempotent.
  void advance(SimTime now);

  /// Takes the oldest end that has not been taken yet.
  std::optional<JobRecord> take_finished();

  /// Jobs submitted and not finished, in order of submission (start_ns is set on those begun).
  std::vector<JobRecord> unfinished() const;

  std::int64_t submitted() const { return next_job_; }

 private:
  struct Job {
    JobRecord record;
    SimDuration done{0};
    bool left = false;  // preempted: taking it up again costs a switch
  };
  enum class Activity { idle, working, switching };
  struct Engine {
    Activity activity = Activity::idle;
    bool on_warp = false;               // the queue worked on or switched to
    SimTime begin, end;                 // of the activity; end may be cut short by a preemption
    std::vector<Job> background, warp;  // FIFO, front is index 0; a handful of jobs at most
  };

  void request_preemption(Engine& engine, SimTime now);
  void finish_activity(Engine& engine);
  void begin_next(Engine& engine, SimTime now);
  void work_on(Engine& engine, bool on_warp, SimTime now);

  QueueKind kind_;
  PreemptionParams preemption_;
  Engine engines_[2];
  std::vector<JobRecord> finished_;
  std::int64_t next_job_ = 0;
};

}  // namespace brace
