#include "bench/replay.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hmd_sim/trace_generators.hpp"
#include "runtime/frame/counted_work.hpp"
#include "runtime/frame/frame_loop.hpp"
#include "runtime/frame/pacing_sink.hpp"
#include "stages/predict/predict.hpp"

namespace brace {

namespace {

// Of the fake pacer of a known open-source OpenXR runtime, over 24 simulated hours at 90 Hz.
struct PublishedRival {
  const char* source = "a known runtime's fake pacer, as published";
  double first_ns_per_vsync = 1.3e3;
  double last_ns_per_vsync = 2.9e6;
  const char* duplicates = "every second frame predicted for the same vsync as the one before";
};

constexpr sim::Rate refresh{90, 1};
constexpr std::int64_t vsyncs_per_hour = 90 * 3600;
constexpr double target_vsyncs_per_s = 300'000;

/// CPU time of this thread.
double cpu_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e9 + static_cast<double>(time.tv_nsec);
}

/// Folds records and notes the CPU time at every simulated hour.
class TimedSink final : public RecordSink {
 public:
  void add(const FrameRecord& record) override {
    pacing_.add(record);
    if ((record.vsync_index + 1) % vsyncs_per_hour == 0) end_hour(vsyncs_per_hour);
  }
  void add(const JobRecord& record) override { pacing_.add(record); }

  void end_hour(std::int64_t vsyncs) {
    const double now_ns = cpu_ns();
    ns_per_vsync_by_hour_.push_back((now_ns - hour_begin_ns_) / static_cast<double>(vsyncs));
    hour_begin_ns_ = now_ns;
  }

  const std::vector<double>& ns_per_vsync_by_hour() const { return ns_per_vsync_by_hour_; }
  PacingFigures figures() const { return pacing_.figures(); }

 private:
  PacingSink pacing_;
  double hour_begin_ns_ = cpu_ns();
  std::vector<double> ns_per_vsync_by_hour_;
};

/// A stage made from its descriptor's defaults.
struct DefaultPredictor {
  DefaultPredictor()
      : self(stages::predict_constant_rate.create(&stages::predict_constant_rate.params[0].default_value,
                                                  1)) {}
  ~DefaultPredictor() { stages::predict_constant_rate.destroy(self); }
  DefaultPredictor(const DefaultPredictor&) = delete;
  DefaultPredictor& operator=(const DefaultPredictor&) = delete;

  PredictStage stage() const {
    return {static_cast<const brace_predict_functions*>(stages::predict_constant_rate.functions), self};
  }
  void* self;
};

/// A ray cast of 11 M samples per eye frame and a warp of both eyes' 1080 x 1200 pixels.
CountedWork typical_work() {
  return CountedWork({{.time = sim_time(0),
                       .cast = {.rays = 200'000, .samples = 11'000'000},
                       .warp = {.texels = 2 * 1080 * 1200}}});
}

ReplayBenchCase replay(QueueKind queue, const char* name, std::int64_t vsyncs, const CostModel& model) {
  const sim::PoseTrace trace =
      sim::generate_trace({.motion = sim::Motion::natural, .seconds = 60, .rate = {250, 1}});
  HeadMotion head(trace, sim::Interpolation::hermite,
                  {.rate = {1000, 1}, .latency = std::chrono::milliseconds(2)}, 1, true, trace.begin_time());
  CountedWork work = typical_work();
  const DefaultPredictor predictor;
  const std::unique_ptr<CostSource> cost = make_model_cost(model, 1.0, 1.0);
  FrameLoopConfig config;
  config.display = {.refresh = refresh,
                    .scan_out = {.direction = sim::ScanDirection::global, .fraction = 0.9},
                    .emission = {},
                    .scan_lines = 1200};
  config.vsyncs_max = vsyncs;
  config.queue = queue;

  TimedSink sink;
  const double begin_ns = cpu_ns();
  const auto begin = std::chrono::steady_clock::now();
  const FrameLoopResult run = run_frame_loop(
      config,
      {.head = head, .predict = predictor.stage(), .control = {}, .cost = *cost, .work = work, .sink = sink});
  ReplayBenchCase result;
  result.name = name;
  result.vsyncs = run.vsyncs;
  result.cpu_s = (cpu_ns() - begin_ns) * 1e-9;
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (vsyncs % vsyncs_per_hour != 0) sink.end_hour(vsyncs % vsyncs_per_hour);
  result.vsyncs_per_s = static_cast<double>(run.vsyncs) / result.cpu_s;
  result.ns_per_vsync_by_hour = sink.ns_per_vsync_by_hour();
  result.events_per_vsync = static_cast<double>(run.events) / static_cast<double>(run.vsyncs);
  result.duplicate_predictions = run.duplicate_predictions;
  result.missed_vsyncs = sink.figures().missed_vsyncs;
  result.eye_frames = run.eye_frames_finished;
  return result;
}

}  // namespace

ReplayBenchResult bench_replay(const ReplayBenchOptions& options) {
  const auto vsyncs_of = [](double hours) {
    return std::max<std::int64_t>(1, std::llround(hours * static_cast<double>(vsyncs_per_hour)));
  };
  const std::int64_t whole = vsyncs_of(options.simulated_hours);
  const std::int64_t hour = vsyncs_of(std::min(options.simulated_hours, 1.0));
  ReplayBenchResult result{options.model.name, options.simulated_hours, {}};
  result.cases.push_back(replay(QueueKind::single, "single", whole, options.model));
  result.cases.push_back(replay(QueueKind::priority, "priority", hour, options.model));
  result.cases.push_back(replay(QueueKind::dual, "dual", hour, options.model));
  return result;
}

std::string to_text(const ReplayBenchResult& result) {
  std::string text =
      fmt::format("pacing-only replay, 90 Hz, one core, CPU time, costs of {}\n\n", result.model);
  text += fmt::format("{:<10}{:>10}{:>14}{:>12}{:>15}{:>12}{:>10}\n", "queue", "vsyncs", "vsyncs/s",
                      "ns/vsync", "events/vsync", "duplicates", "missed");
  for (const ReplayBenchCase& c : result.cases) {
    text +=
        fmt::format("{:<10}{:>10}{:>14.0f}{:>12.0f}{:>15.3f}{:>12}{:>10}\n", c.name, c.vsyncs, c.vsyncs_per_s,
                    1e9 / c.vsyncs_per_s, c.events_per_vsync, c.duplicate_predictions, c.missed_vsyncs);
  }
  text += fmt::format("\ntarget: {:.0f} vsyncs/s; ratio {:.2f}\n", target_vsyncs_per_s,
                      result.cases.front().vsyncs_per_s / target_vsyncs_per_s);
  text += "\nCPU ns per vsync, by simulated hour (single):\n";
  const std::vector<double>& hours = result.cases.front().ns_per_vsync_by_hour;
  for (std::size_t i = 0; i < hours.size(); ++i)
    text += fmt::format("{:>4}{:>9.0f}\n", i + 1, hours[i]);
  const PublishedRival rival;
  text += fmt::format("\nrival ({}): {:.0f} ns per vsync at the start, {:.0f} after 24 h; {}\n", rival.source,
                      rival.first_ns_per_vsync, rival.last_ns_per_vsync, rival.duplicates);
  text += fmt::format("growth over the run: ours x{:.2f}, rival x{:.0f} (published)\n",
                      hours.back() / hours.front(), rival.last_ns_per_vsync / rival.first_ns_per_vsync);
  return text;
}

std::string to_json(const ReplayBenchResult& result) {
  nlohmann::json cases = nlohmann::json::array();
  for (const ReplayBenchCase& c : result.cases) {
    cases.push_back({{"queue", c.name},
                     {"vsyncs", c.vsyncs},
                     {"wall_s", c.wall_s},
                     {"cpu_s", c.cpu_s},
                     {"vsyncs_per_s", c.vsyncs_per_s},
                     {"ns_per_vsync_by_hour", c.ns_per_vsync_by_hour},
                     {"events_per_vsync", c.events_per_vsync},
                     {"duplicate_predictions", c.duplicate_predictions},
                     {"missed_vsyncs", c.missed_vsyncs},
                     {"eye_frames", c.eye_frames}});
  }
  const PublishedRival rival;
  const nlohmann::json json{{"bench", "replay"},
                            {"model", result.model},
                            {"simulated_hours", result.simulated_hours},
                            {"target_vsyncs_per_s", target_vsyncs_per_s},
                            {"cases", cases},
                            {"rival",
                             {{"source", rival.source},
                              {"measured_here", false},
                              {"ns_per_vsync_start", rival.first_ns_per_vsync},
                              {"ns_per_vsync_after_24_h", rival.last_ns_per_vsync},
                              {"duplicate_predictions", rival.duplicates}}}};
  return json.dump(2) + "\n";
}

}  // namespace brace
