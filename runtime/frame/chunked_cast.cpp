#include "runtime/frame/chunked_cast.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace brace {

namespace {

void add(WorkCounts& sum, const WorkCounts& work) {
  sum.rays += work.rays;
  sum.samples += work.samples;
  sum.skip_steps += work.skip_steps;
  sum.shading_fetches += work.shading_fetches;
  sum.texels += work.texels;
  sum.bytes += work.bytes;
}

/// `later` goes on where `record` is.
void append(JobRecord& record, const JobRecord& later) {
  record.end_ns = later.end_ns;
  record.preempted_ns += later.preempted_ns;
  record.cost_ns += later.cost_ns;
  add(record.work, later.work);
}

/// The n-th of `parts` equal parts; they sum up to the whole.
WorkCounts part_of(const WorkCounts& whole, std::uint64_t n, std::uint64_t parts) {
  const auto part = [&](std::uint64_t count) { return count / parts + (n < count % parts ? 1 : 0); };
  return {.rays = part(whole.rays),
          .samples = part(whole.samples),
          .skip_steps = part(whole.skip_steps),
          .shading_fetches = part(whole.shading_fetches),
          .texels = part(whole.texels),
          .bytes = part(whole.bytes)};
}

}  // namespace

ChunkedCast::ChunkedCast(const ChunkedParams& params)
    : schedule_params_(params), schedule_(params), outcomes_(static_cast<std::size_t>(schedule_.cells())) {
  in_flight_.reserve(outcomes_.size());
}

std::span<const CellCuts> ChunkedCast::cut() {
  BRACE_CHECK(schedule_.left() == 0 && first_in_flight_ == in_flight_.size());
  schedule_.begin_frame();
  return cuts();
}

std::span<const CellCuts> ChunkedCast::cuts() const {
  if (schedule_params_.cut == ChunkedParams::Cut::even) return {};
  return schedule_.cuts();
}

void ChunkedCast::begin_frame(std::int64_t frame, const JobOutcome& outcome) {
  frame_ = frame;
  if (outcome.cells.empty()) {
    const std::uint64_t count = outcomes_.size();
    for (std::uint64_t i = 0; i < count; ++i)
      outcomes_[i] = {part_of(outcome.work, i, count),
                      outcome.device_time / static_cast<std::int64_t>(count)};
  } else {
    BRACE_CHECK(outcome.cells.size() == outcomes_.size());
    std::copy(outcome.cells.begin(), outcome.cells.end(), outcomes_.begin());
  }
  samples_ = 0;
  for (const CellOutcome& cell : outcomes_)
    samples_ += cell.work.samples;
  in_flight_.clear();
  first_in_flight_ = 0;
  whole_.reset();
}

double ChunkedCast::share_of(const CellOutcome& cell) const {
  return samples_ > 0 ? static_cast<double>(cell.work.samples) / static_cast<double>(samples_)
                      : 1.0 / static_cast<double>(outcomes_.size());
}

void ChunkedCast::submit_cell(const CellSchedule::Cell& cell, const Submit& submit) {
  schedule_.hand_out(cell);
  in_flight_.push_back(cell);
  may_overrun_ = false;
  const CellOutcome& outcome = outcomes_[static_cast<std::size_t>(cell.number)];
  submit({frame_, cell.number, outcome, share_of(outcome)});
}

void ChunkedCast::submit_what_fits(SimTime now, SimTime deadline, bool gpu_free, const Submit& submit) {
  if (!gpu_free || first_in_flight_ < in_flight_.size()) return;
  const bool batch = schedule_params_.guard == ChunkedParams::Guard::prediction;
  // Algorithm 4: one batch per period, whatever it turns out to take.
  if (batch && !may_overrun_) return;
  SimDuration left = deadline - now;
  do {
    std::optional<CellSchedule::Cell> cell = schedule_.next(left);
    if (!cell && may_overrun_) cell = schedule_.next_in_any_case();
    if (!cell) return;
    submit_cell(*cell, submit);
    left -= cell->predicted;
  } while (batch);
}

std::optional<JobRecord> ChunkedCast::finish_cell(const JobRecord& job, RecordSink& sink) {
  BRACE_CHECK(job.index == frame_ && first_in_flight_ < in_flight_.size());
  schedule_.trace(in_flight_[first_in_flight_++], SimDuration(job.cost_ns));
  const bool last = schedule_.left() == 0 && first_in_flight_ == in_flight_.size();
  if (row_ && row_->end_ns == job.start_ns) {
    append(*row_, job);
  } else {
    flush(sink);
    row_ = job;
    row_->ends_frame = false;
  }
  if (whole_) {
    append(*whole_, job);
  } else {
    whole_ = job;
  }
  if (!last) return std::nullopt;
  row_->ends_frame = true;
  flush(sink);
  return whole_;
}

std::optional<ChunkedCast::Expected> ChunkedCast::expected_cost() const {
  const std::size_t done = first_in_flight_;
  if (done == 0 || done < in_flight_.size() || done == outcomes_.size()) return std::nullopt;
  const double share = static_cast<double>(done) / static_cast<double>(outcomes_.size());
  const SimDuration total(std::llround(static_cast<double>(whole_->cost_ns) / share));
  return Expected{total, total - SimDuration(whole_->cost_ns)};
}

void ChunkedCast::give_up(RecordSink& sink) {
  BRACE_CHECK(first_in_flight_ == in_flight_.size());
  schedule_.drop();
  flush(sink);
}

void ChunkedCast::flush(RecordSink& sink) {
  if (row_) sink.add(*row_);
  row_.reset();
}

}  // namespace brace
