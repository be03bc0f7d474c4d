#pragma once

#include <string>

#include "hmd_sim/trace_generators.hpp"
#include "runtime/frame/frame_loop.hpp"
#include "runtime/frame/pacing_sink.hpp"
#include "runtime/replay/stage_instance.hpp"

namespace brace {

/// A stage with its defaults.
inline PipelineStage with_defaults(const StageInfo& info) {
  PipelineStage stage{info, {}};
  for (const StageParameter& parameter : info.parameters)
    stage.values.push_back(parameter.default_value);
  return stage;
}

/// 90 Hz, lit at once; queue, schedule and length are the caller's.
inline FrameLoopConfig global_90_hz(std::int64_t vsyncs) {
  FrameLoopConfig config;
  config.display = {.refresh = {90, 1},
                    .scan_out = {.direction = sim::ScanDirection::global, .fraction = 0.9},
                    .emission = {},
                    .scan_lines = 1200};
  config.vsyncs_max = vsyncs;
  return config;
}

struct PacingRun {
  FrameLoopResult loop;
  PacingFigures figures;
};

/// A natural head motion, again and again, under built-in stages on simulated time.
inline PacingRun run_pacing(const StageRegistry& stages, const FrameLoopConfig& config, CostSource& cost,
                            FrameWork& work, const std::string& control_name = "fixed") {
  const NativeStage control = live_stage(with_defaults(stages.find("control", control_name, "bench")));
  const NativeStage predict = live_stage(with_defaults(stages.find("predict", "constant_rate", "bench")));
  const sim::PoseTrace trace = sim::generate_trace({.motion = sim::Motion::natural, .seconds = 10});
  HeadMotion head(trace, sim::Interpolation::slerp_linear, {.rate = {1000, 1}, .latency = SimDuration(0)}, 1,
                  true, trace.begin_time());
  PacingSink sink;
  PacingRun run;
  run.loop = run_frame_loop(
      config, {.head = head,
               .predict = {&predict.predict_functions(), predict.self(), predict.place()},
               .control = {&control.control_functions(), control.self(), control.place(), nullptr},
               .cost = cost,
               .work = work,
               .sink = sink});
  run.figures = sink.figures();
  return run;
}

}  // namespace brace
