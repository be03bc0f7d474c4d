#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "bench/mab.hpp"
#include "bench/pacing_rig.hpp"
#include "hmd_sim/random.hpp"
#include "runtime/frame/counted_work.hpp"

namespace brace {

namespace {

constexpr std::int64_t vsyncs = 3000;
constexpr double full_rays = 1e6;
constexpr double ns_per_ray = 4.5;  // a ray per pixel takes about half of what a period leaves

/// How much dearer a ray is than at first.
using Load = double (*)(double time_s);

/// Ten times the load in the middle third of the run.
double step(double time_s) {
  const double third = time_s * 90.0 / (vsyncs / 3.0);
  return third >= 1.0 && third < 2.0 ? 10.0 : 1.0;
}

/// Every 4 s another transfer function: more and more of the volume can be seen through, then none of it.
double transfer_changes(double time_s) {
  constexpr std::array loads = {1.0, 4.0, 2.0, 8.0};
  return loads[static_cast<std::size_t>(std::max(time_s, 0.0) / 4.0) % loads.size()];
}

/// To ten times the size of before and back, in 6 s each way.
double zoom(double time_s) {
  return std::exp(std::log(10.0) * 0.5 * (1.0 - std::cos(std::numbers::pi * time_s / 6.0)));
}

/// Casts take what their rays say, times the load; 5 % noise per job. In cells each job has a share of the
/// rays.
class LoadCost final : public CostSource {
 public:
  explicit LoadCost(Load load) : load_(load) {}
  SimDuration cost(const CostQuery& job) override {
    if (job.kind != JobKind::cast) return SimDuration(500'000);
    const double noise = sim::near_normal(sim::random_bits(sim::stream_of(7, 0), jobs_++));
    const auto rays = static_cast<double>(job.work.rays);
    rays_ += rays;
    return SimDuration(std::llround(rays * ns_per_ray * load_(to_s(job.elapsed)) * std::exp(0.05 * noise)));
  }
  bool deterministic() const override { return true; }
  double rays() const { return rays_; }

 private:
  Load load_;
  std::uint64_t jobs_ = 0;
  double rays_ = 0;
};

struct Scenario {
  const char* name;
  Load load;
};

MabControlRow drive(const StageRegistry& stages, const Scenario& scenario, bool in_cells,
                    const std::string& name) {
  // Any share of the rays down to 2 %.
  CountedWork work({{.time = sim_time(0),
                     .cast = {.rays = static_cast<std::uint64_t>(full_rays)},
                     .cast_below = {{.rays = static_cast<std::uint64_t>(0.02 * full_rays)}}}},
                   SimDuration(0), {0.02});
  LoadCost cost(scenario.load);
  FrameLoopConfig config = global_90_hz(vsyncs);
  if (in_cells) config.chunked = ChunkedParams{.give_up_periods = 1};
  const PacingRun run = run_pacing(stages, config, cost, work, name);
  MabControlRow row;
  row.control = name;
  row.missed_percent = 100.0 * run.figures.missed_ratio;
  row.longest_run = run.figures.longest_stale_run;
  row.ray_share_mean =
      cost.rays() / full_rays / static_cast<double>(std::max<std::int64_t>(run.loop.eye_frames_started, 1));
  row.load = scenario.name;
  row.schedule = in_cells ? "chunked" : "whole_frame";
  row.repeated_percent = 100.0 * run.repeated_ratio;
  row.longest_repeats = run.longest_repeats;
  return row;
}

}  // namespace

std::vector<MabControlRow> mab_control_rows(const StageRegistry& stages) {
  constexpr std::array<Scenario, 3> scenarios{
      {{"step", step}, {"transfer function", transfer_changes}, {"zoom", zoom}}};
  std::vector<MabControlRow> rows;
  for (const Scenario& scenario : scenarios)
    for (const bool in_cells : {false, true})
      for (const char* control : {"fixed", "mab_dynamic", "pi", "quantile"})
        rows.push_back(drive(stages, scenario, in_cells, control));
  return rows;
}

}  // namespace brace
