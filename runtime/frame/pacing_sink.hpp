#pragma once

#include "runtime/frame/record_sink.hpp"
#include "runtime/metrics/pacing.hpp"

namespace brace {

/// Folds records into pacing figures as they come: constant memory, no allocation, for replays of days.
class PacingSink final : public RecordSink {
 public:
  void add(const FrameRecord& record) override { pacing_.add(record); }
  void add(const JobRecord& record) override {
    ++jobs_;
    if (record.kind == JobKind::cast && record.end_ns >= 0 && record.ends_frame)
      pacing_.add_frame_done(record.end_ns);
  }

  PacingFigures figures() const { return pacing_.figures(); }
  FrameRate rate() const { return pacing_.rate(); }
  std::int64_t jobs() const { return jobs_; }

 private:
  PacingAccumulator pacing_;
  std::int64_t jobs_ = 0;
};

}  // namespace brace
