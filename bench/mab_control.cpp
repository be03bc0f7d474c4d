#include <algorithm>
#include <cmath>

#include "bench/mab.hpp"
#include "hmd_sim/random.hpp"
#include "hmd_sim/trace_generators.hpp"
#include "runtime/frame/counted_work.hpp"
#include "runtime/frame/frame_loop.hpp"
#include "runtime/frame/pacing_sink.hpp"
#include "runtime/replay/stage_instance.hpp"

namespace brace {

namespace {

constexpr std::int64_t vsyncs = 3000;
constexpr sim::Rate refresh{90, 1};
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

PipelineStage with_defaults(const StageInfo& info) {
  PipelineStage stage{info, {}};
  for (const StageParameter& parameter : info.parameters)
    stage.values.push_back(parameter.default_value);
  return stage;
}

MabControlRow drive(const StageRegistry& stages, const std::string& name) {
  const NativeStage control = live_stage(with_defaults(stages.find("control", name, "bench")));
  const NativeStage predict = live_stage(with_defaults(stages.find("predict", "constant_rate", "bench")));
  const sim::PoseTrace trace = sim::generate_trace({.motion = sim::Motion::natural, .seconds = 10});
  HeadMotion head(trace, sim::Interpolation::slerp_linear, {.rate = {1000, 1}, .latency = SimDuration(0)}, 1,
                  true, trace.begin_time());
  // Any share of the rays down to 2 %.
  CountedWork work({{.time = sim_time(0),
                     .cast = {.rays = static_cast<std::uint64_t>(full_rays)},
                     .cast_below = {{.rays = static_cast<std::uint64_t>(0.02 * full_rays)}}}},
                   SimDuration(0), {0.02});
  FrameLoopConfig config;
  config.display = {.refresh = refresh,
                    .scan_out = {.direction = sim::ScanDirection::global, .fraction = 0.9},
                    .emission = {},
                    .scan_lines = 1200};
  config.vsyncs_max = vsyncs;
  StepCost cost;
  PacingSink sink;
  run_frame_loop(config, {.head = head,
                          .predict = {&predict.predict_functions(), predict.self(), "predict/constant_rate"},
                          .control = {&control.control_functions(), control.self(), control.place(), nullptr},
                          .cost = cost,
                          .work = work,
                          .sink = sink});
  const PacingFigures figures = sink.figures();
  return {name, 100.0 * figures.missed_ratio, figures.longest_stale_run, cost.ray_share_mean()};
}

}  // namespace

std::vector<MabControlRow> mab_control_rows(const StageRegistry& stages) {
  std::vector<MabControlRow> rows;
  for (const char* control : {"fixed", "mab_dynamic", "pi", "quantile"})
    rows.push_back(drive(stages, control));
  return rows;
}

}  // namespace brace
