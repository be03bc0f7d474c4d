#include "runtime/frame/counted_work.hpp"

#include <algorithm>
#include <cmath>
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

WorkCounts difference(const WorkCounts& a, const WorkCounts& b) {
  return {.rays = a.rays - b.rays,
          .samples = a.samples - b.samples,
          .skip_steps = a.skip_steps - b.skip_steps,
          .shading_fetches = a.shading_fetches - b.shading_fetches,
          .texels = a.texels - b.texels,
          .bytes = a.bytes - b.bytes};
}

}  // namespace

CountedWork::CountedWork(std::vector<WorkProbe> probes, SimDuration period, std::vector<double> qualities)
    : probes_(std::move(probes)), period_(period), qualities_{1.0} {
  for (const double quality : qualities) {
    if (!(quality >= 0.0 && quality < qualities_.back())) {
      throw input_error("counted work: quality {} after {}; accepted: falling ones below 1", quality,
                        qualities_.back());
    }
    qualities_.push_back(quality);
  }
  for (const WorkProbe& probe : probes_) {
    if (probe.cell_shares.size() != probes_.front().cell_shares.size())
      throw input_error("counted work: probes of {} and {} cells", probes_.front().cell_shares.size(),
                        probe.cell_shares.size());
    if (probe.cast_below.size() != qualities.size())
      throw input_error("counted work: a probe has casts at {} qualities below 1; {} are needed",
                        probe.cast_below.size(), qualities.size());
  }
  if (probes_.empty()) throw input_error("counted work: no probes; at least one is needed");
  for (std::size_t i = 1; i < probes_.size(); ++i) {
    if (probes_[i].time <= probes_[i - 1].time) {
      throw input_error("counted work: probe {} does not come after the one before it", i);
    }
  }
  cells_.resize(probes_.front().cell_shares.size());
  shares_.resize(cells_.size());
  if (period_ < SimDuration(0)) throw input_error("counted work: the period is negative");
}

CountedWork::Place CountedWork::place_of(SimTime time) {
  if (period_ > SimDuration(0)) time = SimTime(time.time_since_epoch() % period_);
  if (time <= probes_.front().time) return {probes_.front(), probes_.front(), 0.0};
  if (time >= probes_.back().time) return {probes_.back(), probes_.back(), 0.0};
  if (probes_[cursor_].time > time)
    cursor_ = 0;  // a new turn, or a warp latched before the last cast's start
  while (probes_[cursor_ + 1].time <= time)
    ++cursor_;
  const WorkProbe& before = probes_[cursor_];
  const WorkProbe& after = probes_[cursor_ + 1];
  return {before, after, to_s(time - before.time) / to_s(after.time - before.time)};
}

template <class Counts>
WorkCounts CountedWork::interpolate(SimTime time, const Counts& counts) {
  const Place place = place_of(time);
  return mix(counts(place.before), counts(place.after), place.t);
}

/// Shares of even cells become those of the cells asked for, spread evenly within the former.
void CountedWork::share_by_cuts(const CastRequest& request) {
  if (!even_) {
    even_.emplace(request.cell_columns, request.cell_rows);
    density_.emplace(request.cell_columns, request.cell_rows);
  }
  const std::size_t per_eye = cells_.size() / 2;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const std::span<double> shares = std::span(shares_).subspan(eye * per_eye, per_eye);
    density_->set(*even_, shares);
    for (std::size_t i = 0; i < per_eye; ++i)
      shares[i] = density_->in(request.cuts[eye].area(static_cast<int>(i)));
  }
}

/// By rounded running sums, so that the cells' counts sum up to the whole.
void CountedWork::divide_into_cells(const WorkCounts& whole, const CastRequest& request) {
  const Place place = place_of(request.start);
  for (std::size_t i = 0; i < cells_.size(); ++i)
    shares_[i] = place.before.cell_shares[i] * (1 - place.t) + place.after.cell_shares[i] * place.t;
  if (!request.cuts.empty()) share_by_cuts(request);
  WorkCounts until;
  double sum = 0.0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    sum += shares_[i];
    const WorkCounts next = i + 1 == cells_.size() ? whole : mix({}, whole, std::min(sum, 1.0));
    cells_[i].work = difference(next, until);
    until = next;
  }
}

JobOutcome CountedWork::update(const UpdateRequest& request) {
  return {.work = interpolate(request.start, [](const WorkProbe& probe) { return probe.update; })};
}

JobOutcome CountedWork::cast(const CastRequest& request) {
  std::size_t below = 0;  // the first quality that is not above the one asked for
  while (below + 1 < qualities_.size() && qualities_[below] > request.quality)
    ++below;
  const double low = qualities_[below], high = below == 0 ? 1.0 : qualities_[below - 1];
  const double t = below == 0 ? 0.0 : std::max(0.0, (request.quality - low) / (high - low));
  const auto at = [](const WorkProbe& probe, std::size_t quality) {
    return quality == 0 ? probe.cast : probe.cast_below[quality - 1];
  };
  JobOutcome outcome{.work = interpolate(request.start, [&](const WorkProbe& probe) {
                       return below == 0 ? probe.cast : mix(at(probe, below), at(probe, below - 1), t);
                     })};
  if (request.cell_columns > 0 && !cells_.empty()) {
    divide_into_cells(outcome.work, request);
    outcome.cells = cells_;
  }
  return outcome;
}

CellOutcome CountedWork::cast_cell(const CellRequest& request) {
  const JobOutcome whole = cast(request.frame);
  if (!whole.cells.empty()) return whole.cells[static_cast<std::size_t>(request.cell)];
  const double cells = 2.0 * request.frame.cell_columns * request.frame.cell_rows;
  return {.work = difference(mix({}, whole.work, (request.cell + 1) / cells),
                             mix({}, whole.work, request.cell / cells))};
}

JobOutcome CountedWork::warp(const WarpRequest& request) {
  return {.work = interpolate(request.start, [](const WorkProbe& probe) { return probe.warp; })};
}

}  // namespace brace
