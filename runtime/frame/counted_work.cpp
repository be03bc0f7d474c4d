#include "runtime/frame/counted_work.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "base/error.hpp"

namespace brace {

namespace {

std::uint64_t mix(std::uint64_t a, std::uint64_t b, double t) {
  return static_cast<std::uint64_t>(
      std::llround(static_cast<double>(a) * (1 - t) + static_cast<double>(b) * t));
}

WorkCounts mix(const WorkCounts& a, const WorkCounts& b, double t) {
  return {.rays = mix(a.rays, b.rays, t),
          .samples = mix(a.samples, b.samples, t),
          .skip_steps = mix(a.skip_steps, b.skip_steps, t),
          .shading_fetches = mix(a.shading_fetches, b.shading_fetches, t),
          .texels = mix(a.texels, b.texels, t),
          .bytes = mix(a.bytes, b.bytes, t)};
}

}  // namespace

CountedWork::CountedWork(std::vector<WorkProbe> probes, SimDuration period)
    : probes_(std::move(probes)), period_(period) {
  if (probes_.empty()) throw input_error("counted work: no probes; at least one is needed");
  for (std::size_t i = 1; i < probes_.size(); ++i) {
    if (probes_[i].time <= probes_[i - 1].time) {
      throw input_error("counted work: probe {} does not come after the one before it", i);
    }
  }
  if (period_ < SimDuration(0)) throw input_error("counted work: the period is negative");
}

WorkCounts CountedWork::interpolate(SimTime time, WorkCounts WorkProbe::*counts) {
  if (period_ > SimDuration(0)) time = SimTime(time.time_since_epoch() % period_);
  if (time <= probes_.front().time) return probes_.front().*counts;
  if (time >= probes_.back().time) return probes_.back().*counts;
  if (probes_[cursor_].time > time)
    cursor_ = 0;  // a new turn, or a warp latched before the last cast's start
  while (probes_[cursor_ + 1].time <= time)
    ++cursor_;
  const WorkProbe& before = probes_[cursor_];
  const WorkProbe& after = probes_[cursor_ + 1];
  const double t = to_s(time - before.time) / to_s(after.time - before.time);
  return mix(before.*counts, after.*counts, t);
}

JobOutcome CountedWork::update(const UpdateRequest& request) {
  return {.work = interpolate(request.start, &WorkProbe::update)};
}

JobOutcome CountedWork::cast(const CastRequest& request) {
  const WorkCounts full = interpolate(request.start, &WorkProbe::cast);
  if (request.quality == 1.0) return {.work = full};
  WorkCounts work = mix(WorkCounts{}, full, request.quality);
  work.texels = full.texels;
  work.bytes = full.bytes;
  return {.work = work};
}

JobOutcome CountedWork::warp(const WarpRequest& request) {
  return {.work = interpolate(request.start, &WorkProbe::warp)};
}

ShowOutcome CountedWork::show(const ShowRequest&) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return {nan, nan};
}

}  // namespace brace
