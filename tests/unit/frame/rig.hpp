#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "hmd_sim/trace_generators.hpp"
#include "runtime/frame/counted_work.hpp"
#include "runtime/frame/frame_loop.hpp"
#include "stages/predict/predict.hpp"

namespace brace {

/// A stage with its defaults, through its descriptor.
class Stage {
 public:
  explicit Stage(const brace_stage_descriptor& descriptor) : descriptor_(descriptor) {
    std::vector<double> values;
    for (std::uint32_t i = 0; i < descriptor.param_count; ++i)
      values.push_back(descriptor.params[i].default_value);
    self_ = descriptor.create(values.data(), descriptor.param_count);
  }
  ~Stage() { descriptor_.destroy(self_); }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  PredictStage predict() const {
    return {static_cast<const brace_predict_functions*>(descriptor_.functions), self_};
  }
  ControlStage control() const {
    return {static_cast<const brace_control_functions*>(descriptor_.functions), self_};
  }

 private:
  const brace_stage_descriptor& descriptor_;
  void* self_;
};

constexpr SimDuration ms(double milliseconds) {
  return from_s(milliseconds * 1e-3);
}

/// 90 Hz; the lines are scanned out over the whole period, light comes at once: photon_mid = vsync + half a
/// period.
inline Display test_display() {
  return {.refresh = {90, 1},
          .scan_out = {.direction = sim::ScanDirection::top_to_bottom, .fraction = 1.0},
          .emission = {},
          .scan_lines = 1000};
}

/// Everything one replay needs, with members to change before run().
struct Rig {
  explicit Rig(sim::MotionSpec motion = {.motion = sim::Motion::natural, .seconds = 2},
               sim::TrackerModel tracker_model = {.rate = {1000, 1}, .latency = SimDuration(0)})
      : trace(sim::generate_trace(motion)), tracker(tracker_model) {
    config.display = test_display();
  }

  FrameLoopResult run(RecordSink& sink, CostSource& cost) {
    HeadMotion head(trace, sim::Interpolation::slerp_linear, tracker, seed, loop, trace.begin_time());
    const Stage stage(*predictor);
    CountedWork counted({{.time = sim_time(0), .cast = {.samples = 1}, .warp = {.texels = 1}}});
    return run_frame_loop(config, {.head = head,
                                   .predict = stage.predict(),
                                   .control = control,
                                   .cost = cost,
                                   .work = work != nullptr ? *work : counted,
                                   .sink = sink,
                                   .gaze = gaze,
                                   .wall = wall});
  }

  /// With scripted costs.
  RunRecords run(const std::vector<CostSegment>& script) {
    RunRecords records;
    const std::unique_ptr<CostSource> cost = make_scripted_cost(script, 1.0);
    result = run(records, *cost);
    return records;
  }
  RunRecords run(double cast_ms, double warp_ms) {
    return run(std::vector<CostSegment>{{0, cast_ms, warp_ms, 0}});
  }

  sim::PoseTrace trace;
  sim::TrackerModel tracker;
  bool loop = false;
  std::uint64_t seed = 1;
  const brace_stage_descriptor* predictor = &stages::predict_constant_rate;
  ControlStage control;
  FrameWork* work = nullptr;  // counted work if null
  GazeMotion* gaze = nullptr;
  WallClock* wall = nullptr;
  FrameLoopConfig config;
  FrameLoopResult result;  // of the last scripted run
};

/// Durations drawn anew for every job, the same for the same seed.
class RandomCost final : public CostSource {
 public:
  RandomCost(std::uint64_t seed, double cast_max_ms, double warp_max_ms)
      : state_(seed), cast_max_ms_(cast_max_ms), warp_max_ms_(warp_max_ms) {}
  SimDuration cost(const CostQuery& query) override {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    const double uniform = static_cast<double>(state_ >> 11) * 0x1p-53;
    return ms(uniform * (query.kind == JobKind::cast ? cast_max_ms_ : warp_max_ms_));
  }
  bool deterministic() const override { return true; }

 private:
  std::uint64_t state_;
  double cast_max_ms_, warp_max_ms_;
};

constexpr std::int64_t vsync_ns(std::int64_t k) {
  return k * 1'000'000'000 / 90;
}
constexpr std::int64_t floor_to_ms(std::int64_t ns) {
  return ns / 1'000'000 * 1'000'000;
}

}  // namespace brace
