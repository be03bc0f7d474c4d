#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/time.hpp"
#include "hmd_sim/vsync.hpp"

namespace brace {

/// When the scene's transfer function changes, in run time. Version 0 is in force from the start, version k
/// from the k-th change on.
class TransferSchedule {
 public:
  TransferSchedule() = default;  // it never changes

  /// Changes at these times: after 0, in rising order.
  explicit TransferSchedule(std::vector<SimTime> changes) : changes_(std::move(changes)) {
    for (std::size_t i = 0; i < changes_.size(); ++i)
      BRACE_CHECK(changes_[i] > (i == 0 ? SimTime() : changes_[i - 1]));
  }

  /// A change at every vsync but the first.
  static TransferSchedule at_every_vsync(sim::Rate refresh) {
    TransferSchedule schedule;
    schedule.vsyncs_.emplace(SimTime(), refresh);
    return schedule;
  }

  std::int64_t version_at(SimTime time) const {
    if (vsyncs_) return std::max<std::int64_t>(vsyncs_->last_at_or_before(time), 0);
    return std::upper_bound(changes_.begin(), changes_.end(), time) - changes_.begin();
  }

  /// Times of single changes; none if there is one at every vsync.
  const std::vector<SimTime>& changes() const { return changes_; }

 private:
  std::vector<SimTime> changes_;
  std::optional<sim::VsyncClock> vsyncs_;
};

}  // namespace brace
