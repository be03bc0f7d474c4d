#include "runtime/timeline/simulated_gpu.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr std::size_t queue_capacity = 16;  // reserved; more only makes it allocate once

bool has_begun(const JobRecord& record) {
  return record.start_ns >= 0;
}

}  // namespace

SimulatedGpu::SimulatedGpu(QueueKind kind, const PreemptionParams& preemption)
    : kind_(kind), preemption_(preemption) {
  BRACE_CHECK(preemption.granularity >= SimDuration(0) && preemption.switch_cost >= SimDuration(0));
  for (Engine& engine : engines_) {
    engine.background.reserve(queue_capacity);
    engine.warp.reserve(queue_capacity);
  }
  finished_.reserve(queue_capacity);
}

std::int64_t SimulatedGpu::submit(const GpuJob& job, SimTime now) {
  BRACE_CHECK(job.cost >= SimDuration(0));
  advance(now);
  Job queued;
  queued.record = {.job = next_job_++,
                   .kind = job.kind,
                   .index = job.index,
                   .submit_ns = to_ns(now),
                   .cost_ns = to_ns(job.cost),
                   .work = job.work};
  const bool is_warp = job.kind == JobKind::warp;
  Engine& engine = engines_[kind_ == QueueKind::dual && is_warp ? 1 : 0];
  const bool goes_first = kind_ == QueueKind::priority && is_warp;
  (goes_first ? engine.warp : engine.background).push_back(queued);
  if (engine.activity == Activity::idle) {
    begin_next(engine, now);
  } else if (goes_first && engine.activity == Activity::working && !engine.on_warp) {
    request_preemption(engine, now);
  }
  return queued.record.job;  // a free job ends with the caller's next advance(now), as next_change() says
}

std::optional<SimTime> SimulatedGpu::next_change() const {
  std::optional<SimTime> next;
  for (const Engine& engine : engines_) {
    if (engine.activity != Activity::idle && (!next || engine.end < *next)) next = engine.end;
  }
  return next;
}

void SimulatedGpu::advance(SimTime now) {
  while (true) {
    Engine* due = nullptr;  // earliest first, so that ends come out in the order of time
    for (Engine& engine : engines_) {
      if (engine.activity == Activity::idle || engine.end > now) continue;
      if (due == nullptr || engine.end < due->end) due = &engine;
    }
    if (due == nullptr) return;
    finish_activity(*due);
  }
}

std::optional<JobRecord> SimulatedGpu::take_finished() {
  if (finished_.empty()) return std::nullopt;
  const JobRecord record = finished_.front();
  finished_.erase(finished_.begin());
  return record;
}

std::vector<JobRecord> SimulatedGpu::unfinished() const {
  std::vector<JobRecord> records;
  for (const Engine& engine : engines_) {
    for (const Job& job : engine.background)
      records.push_back(job.record);
    for (const Job& job : engine.warp)
      records.push_back(job.record);
  }
  std::sort(records.begin(), records.end(),
            [](const JobRecord& a, const JobRecord& b) { return a.job < b.job; });
  return records;
}

/// Cuts the running background job's activity at its next preemption point at or after `now`.
void SimulatedGpu::request_preemption(Engine& engine, SimTime now) {
  const Job& job = engine.background.front();
  const std::int64_t granularity_ns = to_ns(preemption_.granularity);
  std::int64_t work_ns = to_ns(job.done + (now - engine.begin));
  if (granularity_ns > 0) work_ns = (work_ns + granularity_ns - 1) / granularity_ns * granularity_ns;
  engine.end = std::min(engine.end, engine.begin + (SimDuration(work_ns) - job.done));
}

void SimulatedGpu::finish_activity(Engine& engine) {
  const SimTime now = engine.end;
  std::vector<Job>& queue = engine.on_warp ? engine.warp : engine.background;
  if (engine.activity == Activity::switching) {
    if (engine.on_warp) return work_on(engine, true, now);
    queue.front().left = false;
    return begin_next(engine, now);
  }
  Job& job = queue.front();
  job.done += engine.end - engine.begin;
  if (to_ns(job.done) == job.record.cost_ns) {
    job.record.end_ns = to_ns(now);
    job.record.preempted_ns = job.record.end_ns - job.record.start_ns - job.record.cost_ns;
    finished_.push_back(job.record);
    queue.erase(queue.begin());
  }
  begin_next(engine, now);
}

void SimulatedGpu::begin_next(Engine& engine, SimTime now) {
  Job* background = engine.background.empty() ? nullptr : &engine.background.front();
  const auto switch_to = [&](bool warp) {
    engine.activity = Activity::switching;
    engine.on_warp = warp;
    engine.begin = now;
    engine.end = now + preemption_.switch_cost;
  };
  if (!engine.warp.empty()) {
    const bool must_leave = background != nullptr && has_begun(background->record) && !background->left;
    if (!must_leave) return work_on(engine, true, now);
    background->left = true;
    return switch_to(true);
  }
  if (background == nullptr) {
    engine.activity = Activity::idle;
  } else if (background->left) {
    switch_to(false);
  } else {
    work_on(engine, false, now);
  }
}

void SimulatedGpu::work_on(Engine& engine, bool on_warp, SimTime now) {
  Job& job = (on_warp ? engine.warp : engine.background).front();
  if (!has_begun(job.record)) job.record.start_ns = to_ns(now);
  engine.activity = Activity::working;
  engine.on_warp = on_warp;
  engine.begin = now;
  engine.end = now + (SimDuration(job.record.cost_ns) - job.done);
}

}  // namespace brace
