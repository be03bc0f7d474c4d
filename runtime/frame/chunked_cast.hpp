#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "runtime/frame/cell_schedule.hpp"
#include "runtime/frame/frame_work.hpp"
#include "runtime/frame/record_sink.hpp"

namespace brace {

/// The eye frame that schedule/chunked is at: its cells on their way through the GPU. Cells that follow each
/// other without a gap are one row of the records.
class ChunkedCast {
 public:
  explicit ChunkedCast(const ChunkedParams& params);

  const ChunkedParams& params() const { return schedule_params_; }
  int cells() const { return schedule_.cells(); }

  /// Cuts a new frame into cells; the one before must be done. Of the left and the right eye; empty: even.
  std::span<const CellCuts> cut();
  /// The frame's: what cut() gave.
  std::span<const CellCuts> cuts() const;
  /// Takes the outcomes of the cells it was cut into; the one before must be done. Without any in `outcome`
  /// the frame's work is taken to be spread evenly. With poses of their own cells have no outcome yet.
  void begin_frame(std::int64_t frame, const JobOutcome& outcome);
  /// A display period begins: one cell may be cast whatever it takes.
  void begin_period() { may_overrun_ = true; }

  /// One cell as a job.
  struct CellJob {
    std::int64_t frame = 0;
    int cell = 0;
    CellOutcome outcome;  // as begin_frame was told
    double share = 1.0;   // of the frame's work
  };
  using Submit = std::function<void(const CellJob&)>;

  /// Submits the cells that fit before `deadline`, of the clock's guard at most one; `gpu_free`: nothing that
  /// ray casting would wait for is on the GPU.
  void submit_what_fits(SimTime now, SimTime deadline, bool gpu_free, const Submit& submit);

  /// The oldest cell is done. Rows go to `sink`; the frame's own record comes with its last cell: from the
  /// first submission to the last end, costs summed up.
  std::optional<JobRecord> finish_cell(const JobRecord& job, RecordSink& sink);
  /// What the frame will have cost, from its cells that are done; empty while one is in flight, before the
  /// first is done, and once all are.
  struct Expected {
    SimDuration total, left;
  };
  std::optional<Expected> expected_cost() const;
  /// The rest of the frame is not cast: begin_frame is next. Nothing may be in flight.
  void give_up(RecordSink& sink);

  /// The row that is still open goes to `sink`.
  void flush(RecordSink& sink);

 private:
  void submit_cell(const CellSchedule::Cell& cell, const Submit& submit);
  double share_of(const CellOutcome& cell) const;

  ChunkedParams schedule_params_;
  CellSchedule schedule_;
  std::vector<CellOutcome> outcomes_;          // of the frame's cells
  std::vector<CellSchedule::Cell> in_flight_;  // in order of submission
  std::size_t first_in_flight_ = 0;
  std::int64_t frame_ = -1;
  std::uint64_t samples_ = 0;  // of the frame
  bool may_overrun_ = true;
  std::optional<JobRecord> row_, whole_;
};

}  // namespace brace
