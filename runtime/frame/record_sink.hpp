#pragma once

#include <vector>

#include "base/error.hpp"
#include "runtime/metrics/frame_record.hpp"
#include "runtime/timeline/job_record.hpp"

namespace brace {

/// Where the frame loop's records go. Two implementations: RunRecords keeps them, PacingSink
/// (pacing_sink.hpp) folds them into figures in constant memory for replays of days.
class RecordSink {
 public:
  virtual ~RecordSink() = default;
  /// In the order of vsyncs.
  virtual void add(const FrameRecord& record) = 0;
  /// In the order of their ends; those the run's end left unfinished come last.
  virtual void add(const JobRecord& record) = 0;
};

class RunRecords final : public RecordSink {
 public:
  void add(const FrameRecord& record) override { frames_.push_back(record); }
  void add(const JobRecord& record) override { jobs_.push_back(record); }

  /// Image errors are known later than the rest of a vsync that is recorded.
  void set_errors(std::int64_t vsync_index, const PanelErrors& errors) {
    FrameRecord& record = frames_[static_cast<std::size_t>(vsync_index)];
    BRACE_CHECK(record.vsync_index == vsync_index);
    record.dssim_left = errors.dssim_left;
    record.dssim_right = errors.dssim_right;
    record.weighted_rmse_left = errors.weighted_rmse_left;
    record.weighted_rmse_right = errors.weighted_rmse_right;
  }

  const std::vector<FrameRecord>& frames() const { return frames_; }
  /// As they came, by end. to_costs_csv wants them by submission: see jobs_by_submission.
  const std::vector<JobRecord>& jobs() const { return jobs_; }
  std::vector<JobRecord> jobs_by_submission() const;

 private:
  std::vector<FrameRecord> frames_;
  std::vector<JobRecord> jobs_;
};

}  // namespace brace
