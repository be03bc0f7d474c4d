#include <algorithm>
#include <cmath>

#include "bench/mab.hpp"
#include "bench/pacing_rig.hpp"
#include "hmd_sim/random.hpp"
#include "runtime/frame/counted_work.hpp"

namespace brace {

namespace {

constexpr std::int64_t vsyncs = 3000;
constexpr double full_rays = 1e6;
constexpr double ns_per_ray = 4.5;  // a ray per pixel takes about half of what a period leaves

/// Casts take what their rays say, ten times as much in the middle third; 5 % noise.
class StepCost final : public CostSource {
 public:
  SimDuration cost(const CostQuery& job) override {
    if (job.kind != JobKind::cast) return SimDuration(500'000);
    const double noise = sim::near_normal(sim::random_bits(sim::stream_of(7, 0), casts_++));
    const double third = to_s(job.elapsed) * 90.0 / (vsyncs / 3.0);
    const double load = third >= 1.0 && third < 2.0 ? 10.0 : 1.0;
    const auto rays = static_cast<double>(job.work.rays);
    rays_ += rays;
    return SimDuration(std::llround(rays * ns_per_ray * load * std::exp(0.05 * noise)));
  }
  bool deterministic() const override { return true; }
  double ray_share_mean() const {
    return rays_ / full_rays / static_cast<double>(std::max<std::uint64_t>(casts_, 1));
  }

 private:
  std::uint64_t casts_ = 0;
  double rays_ = 0;
};

MabControlRow drive(const StageRegistry& stages, const std::string& name) {
  // Any share of the rays down to 2 %.
  CountedWork work({{.time = sim_time(0),
                     .cast = {.rays = static_cast<std::uint64_t>(full_rays)},
                     .cast_below = {{.rays = static_cast<std::uint64_t>(0.02 * full_rays)}}}},
                   SimDuration(0), {0.02});
  StepCost cost;
  const PacingRun run = run_pacing(stages, global_90_hz(vsyncs), cost, work, name);
  return {name, 100.0 * run.figures.missed_ratio, run.figures.longest_stale_run, cost.ray_share_mean()};
}

}  // namespace

std::vector<MabControlRow> mab_control_rows(const StageRegistry& stages) {
  std::vector<MabControlRow> rows;
  for (const char* control : {"fixed", "mab_dynamic", "pi", "quantile"})
    rows.push_back(drive(stages, control));
  return rows;
}

}  // namespace brace
