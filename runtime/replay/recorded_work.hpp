#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "runtime/frame/frame_work.hpp"
#include "runtime/timeline/job_record.hpp"

namespace brace {

/// The counted work of an earlier run without pixels, for `recorded:` costs: the n-th job of a kind did what
/// the n-th of this kind did then (in the order of frames and vsyncs, as make_recorded_cost reads them).
class RecordedWork final : public FrameWork {
 public:
  /// `run` is a run directory or its costs.csv. Throws input_error.
  explicit RecordedWork(const std::filesystem::path& run);

  JobOutcome update(const UpdateRequest&) override { return next(JobKind::update); }
  JobOutcome cast(const CastRequest&) override { return next(JobKind::cast); }
  JobOutcome warp(const WarpRequest&) override { return next(JobKind::warp); }

 private:
  /// No work beyond the recording's end; the cost source tells of that.
  JobOutcome next(JobKind kind);

  std::array<std::vector<WorkCounts>, job_kind_count> work_;
  std::array<std::size_t, job_kind_count> done_{};
};

}  // namespace brace
