#pragma once

#include <algorithm>
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

/// How long the panel shows one eye frame, whatever warps make of it.
class EyeFrameSink final : public RecordSink {
 public:
  void add(const FrameRecord& record) override {
    pacing.add(record);
    if (record.displayed_frame < 0) return;
    ++vsyncs;
    repeated = record.displayed_frame == shown ? repeated + 1 : 0;
    shown = record.displayed_frame;
    repeats += repeated > 0;
    longest = std::max(longest, repeated);
  }
  void add(const JobRecord& record) override { pacing.add(record); }

  PacingSink pacing;
  std::int64_t vsyncs = 0, repeats = 0, longest = 0;  // repeats: vsyncs that show the eye frame before again

 private:
  std::int64_t shown = -1, repeated = 0;
};

struct PacingRun {
  FrameLoopResult loop;
  PacingFigures figures;
  double repeated_ratio = 0.0;       // vsyncs that show the same eye frame as the one before
  std::int64_t longest_repeats = 0;  // of them one after the other
};

/// A natural head motion, again and again, under built-in stages on simulated time.
inline PacingRun run_pacing(const StageRegistry& stages, const FrameLoopConfig& config, CostSource& cost,
                            FrameWork& work, const std::string& control_name = "fixed") {
  const NativeStage control = live_stage(with_defaults(stages.find("control", control_name, "bench")));
  const NativeStage predict = live_stage(with_defaults(stages.find("predict", "constant_rate", "bench")));
  const sim::PoseTrace trace = sim::generate_trace({.motion = sim::Motion::natural, .seconds = 10});
  HeadMotion head(trace, sim::Interpolation::slerp_linear, {.rate = {1000, 1}, .latency = SimDuration(0)}, 1,
                  true, trace.begin_time());
  EyeFrameSink sink;
  PacingRun run;
  run.loop = run_frame_loop(
      config, {.head = head,
               .predict = {&predict.predict_functions(), predict.self(), predict.place()},
               .control = {&control.control_functions(), control.self(), control.place(), nullptr},
               .cost = cost,
               .work = work,
               .sink = sink});
  run.figures = sink.pacing.figures();
  run.repeated_ratio =
      static_cast<double>(sink.repeats) / static_cast<double>(std::max<std::int64_t>(sink.vsyncs, 1));
  run.longest_repeats = sink.longest;
  return run;
}

}  // namespace brace
