#pragma once

#include <cstddef>
#include <vector>

#include "runtime/frame/frame_work.hpp"

namespace brace {

/// Counted work at a time of the run, from a probe rendered there.
struct WorkProbe {
  SimTime time;
  WorkCounts cast{};
  WorkCounts warp{};
  WorkCounts update{};  // of a change of the transfer function to the version in force there
};

/// FrameWork without pixels, for pacing-only replays: counts are interpolated linearly between probes
/// (nearest integer) and held beyond the first and the last; one probe is a constant. `quality` scales rays,
/// samples, skip steps and fetches of casts. With a period the probes repeat (a looping trace). Does not
/// allocate after construction; dssim is NaN.
class CountedWork final : public FrameWork {
 public:
  /// Probes in increasing time, at least one; throws input_error otherwise. period 0: none.
  explicit CountedWork(std::vector<WorkProbe> probes, SimDuration period = SimDuration(0));

  JobOutcome update(const UpdateRequest& request) override;
  JobOutcome cast(const CastRequest& request) override;
  JobOutcome warp(const WarpRequest& request) override;
  ShowOutcome show(const ShowRequest& request) override;

 private:
  WorkCounts interpolate(SimTime time, WorkCounts WorkProbe::*counts);

  std::vector<WorkProbe> probes_;
  SimDuration period_;
  std::size_t cursor_ = 0;  // forward walks are amortised O(1)
};

}  // namespace brace
