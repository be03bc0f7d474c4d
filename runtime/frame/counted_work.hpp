#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "runtime/frame/frame_work.hpp"

namespace brace {

/// Counted work at a time of the run, from a probe rendered there.
struct WorkProbe {
  SimTime time;
  WorkCounts cast{};                     // at quality 1
  std::vector<WorkCounts> cast_below{};  // at the qualities below 1 that CountedWork is told
  WorkCounts warp{};
  WorkCounts update{};                // of a change of the transfer function to the version in force there
  std::vector<double> cell_shares{};  // of a cast in even cells: each one's part of the work; the sum is 1
};

/// FrameWork without pixels, for pacing-only replays: counts are interpolated linearly between probes
/// (nearest integer) and held beyond the first and the last; one probe is a constant. Casts are interpolated
/// between qualities, too, and the lowest is held. With a period the probes repeat (a looping trace). Does
/// not allocate after construction; dssim is NaN.
class CountedWork final : public FrameWork {
 public:
  /// Probes in increasing time, at least one; throws input_error otherwise. period 0: none.
  /// `qualities`: below 1 and falling, one for each entry of the probes' cast_below; without any, the quality
  /// asked for has no effect.
  explicit CountedWork(std::vector<WorkProbe> probes, SimDuration period = SimDuration(0),
                       std::vector<double> qualities = {});

  JobOutcome update(const UpdateRequest& request) override;
  JobOutcome cast(const CastRequest& request) override;
  CellOutcome cast_cell(const CellRequest& request) override;
  JobOutcome warp(const WarpRequest& request) override;

 private:
  template <class Counts>
  WorkCounts interpolate(SimTime time, const Counts& counts);
  /// The probes around a time and the place between them.
  struct Place {
    const WorkProbe &before, &after;
    double t;
  };
  Place place_of(SimTime time);
  void share_by_cuts(const CastRequest& request);
  void divide_into_cells(const WorkCounts& whole, const CastRequest& request);

  std::vector<WorkProbe> probes_;
  SimDuration period_;
  std::vector<double> qualities_;   // from 1 on
  std::vector<CellOutcome> cells_;  // of the last cast
  std::vector<double> shares_;      // of its cells
  std::optional<CellCuts> even_;    // of the probes; with cuts by cost
  std::optional<CostDensity> density_;
  std::size_t cursor_ = 0;  // forward walks are amortised O(1)
};

}  // namespace brace
