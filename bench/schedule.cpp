#include "bench/schedule.hpp"

#include <array>
#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/pacing_rig.hpp"

namespace brace {

namespace {

constexpr std::int64_t vsyncs = 3000;

/// Eye frames whose samples are nanoseconds.
class WanderingWork final : public FrameWork {
 public:
  JobOutcome update(const UpdateRequest&) override { return {}; }
  JobOutcome warp(const WarpRequest&) override { return {}; }

  JobOutcome cast(const CastRequest& request) override {
    const double s = to_s(request.start);
    const double third = s * 90.0 / (vsyncs / 3.0);
    const double frame_ns = third >= 1.0 && third < 2.0 ? 60e6 : 6e6;
    JobOutcome outcome{.work = {.samples = static_cast<std::uint64_t>(frame_ns)}};
    if (request.cell_columns == 0) return outcome;
    weigh(request, s);
    outcome.work.samples = 0;
    for (CellOutcome& cell : cells_) {
      cell.work.samples =
          static_cast<std::uint64_t>(frame_ns * static_cast<double>(cell.work.samples) * 1e-9);
      outcome.work.samples += cell.work.samples;
    }
    outcome.cells = cells_;
    return outcome;
  }

 private:
  /// Parts of a billion: nine tenths of the work under a bell that goes round in four seconds. Summed up over
  /// a fine grid, so that it can be cut anywhere.
  void weigh(const CastRequest& request, double s) {
    constexpr int fine = 64;
    std::vector<double> weights;
    double sum = 0.0;
    for (int i = 0; i < fine * fine; ++i) {
      const double x = (i % fine + 0.5) / fine - 0.5 - 0.25 * std::cos(1.57 * s);
      const double y = (i / fine + 0.5) / fine - 0.5 - 0.25 * std::sin(1.57 * s);
      weights.push_back(std::exp(-(x * x + y * y) / 0.03) + 0.01);
      sum += 2.0 * weights.back();
    }
    density_.set(CellCuts(fine, fine), weights);
    const CellCuts even(request.cell_columns, request.cell_rows);
    const int per_eye = request.cell_columns * request.cell_rows;
    cells_.assign(static_cast<std::size_t>(2 * per_eye), {});
    for (int i = 0; i < 2 * per_eye; ++i) {
      const CellCuts& cuts =
          request.cuts.empty() ? even : request.cuts[static_cast<std::size_t>(i / per_eye)];
      cells_[static_cast<std::size_t>(i)].work.samples =
          static_cast<std::uint64_t>(1e9 * density_.in(cuts.area(i % per_eye)) / sum);
    }
  }

  CostDensity density_{64, 64};
  std::vector<CellOutcome> cells_;
};

class SampleCost final : public CostSource {
 public:
  SimDuration cost(const CostQuery& query) override {
    return query.kind == JobKind::cast ? SimDuration(static_cast<std::int64_t>(query.work.samples))
                                       : SimDuration(1'000'000);
  }
  bool deterministic() const override { return true; }
};

ScheduleBenchRow measure(const ScheduleBenchOptions& options, QueueKind queue,
                         const std::optional<ChunkedParams>& chunked) {
  FrameLoopConfig config = global_90_hz(vsyncs);
  config.pace = Pace::free;
  config.queue = queue;
  config.chunked = chunked;
  WanderingWork work;
  SampleCost cost;
  const PacingRun run = run_pacing(options.stages, config, cost, work);
  ScheduleBenchRow row;
  row.missed = run.figures.missed_vsyncs;
  row.longest_run = run.figures.longest_stale_run;
  row.eye_frames = run.loop.eye_frames_finished;
  row.mtp_translation_p50_ms = run.figures.mtp_translation_ms.p50;
  return row;
}

ChunkedParams params_of(ChunkedParams::Guard guard, int edge, double bias, double overhead_us) {
  ChunkedParams params;
  params.guard = guard;
  params.columns = params.rows = edge;
  params.bias = bias;
  params.cell_overhead = from_s(overhead_us * 1e-6);
  return params;
}

std::vector<std::pair<std::string, ChunkedParams>> cases() {
  using Guard = ChunkedParams::Guard;
  std::vector<std::pair<std::string, ChunkedParams>> all;
  for (const double overhead_us : {0.0, 10.0})
    for (const int edge : {4, 6, 8, 16})
      all.emplace_back(fmt::format("clock {0} x {0}", edge), params_of(Guard::clock, edge, 1.0, overhead_us));
  for (const auto order : {ChunkedParams::Order::cost, ChunkedParams::Order::gaze}) {
    all.emplace_back("clock 8 x 8", params_of(Guard::clock, 8, 1.0, 0.0));
    all.back().second.order = order;
  }
  for (const auto& [edge, overhead_us] :
       {std::pair(4, 0.0), {6, 0.0}, {8, 0.0}, {4, 10.0}, {5, 10.0}, {6, 10.0}, {8, 10.0}}) {
    all.emplace_back(fmt::format("clock {0} x {0}, by cost", edge),
                     params_of(Guard::clock, edge, 1.0, overhead_us));
    all.back().second.cut = ChunkedParams::Cut::cost;
  }
  for (const double bias : {1.0, 2.0, 4.0})
    all.emplace_back(fmt::format("prediction 8 x 8, bias {}", bias),
                     params_of(Guard::prediction, 8, bias, 0.0));
  return all;
}

}  // namespace

ScheduleBenchResult bench_schedule(const ScheduleBenchOptions& options) {
  constexpr std::array<std::pair<QueueKind, const char*>, 3> queues{
      {{QueueKind::single, "single"}, {QueueKind::priority, "priority"}, {QueueKind::dual, "dual"}}};
  constexpr std::array orders = {"rows", "cost", "gaze"};
  ScheduleBenchResult result;
  for (const auto& [queue, queue_name] : queues) {
    ScheduleBenchRow whole = measure(options, queue, std::nullopt);
    whole.queue = queue_name;
    whole.schedule = "whole_frame";
    whole.throughput = 1.0;
    const auto whole_frames = static_cast<double>(whole.eye_frames);
    result.rows.push_back(std::move(whole));
    for (const auto& [name, params] : cases()) {
      ScheduleBenchRow row = measure(options, queue, params);
      row.queue = queue_name;
      row.schedule = name;
      row.order = orders[static_cast<std::size_t>(params.order)];
      row.overhead_us = to_s(params.cell_overhead) * 1e6;
      row.throughput = static_cast<double>(row.eye_frames) / whole_frames;
      result.rows.push_back(std::move(row));
    }
  }
  return result;
}

std::string to_text(const ScheduleBenchResult& result) {
  std::string text =
      "3,000 vsyncs at 90 Hz, eye frames of 6 ms, ten times as much in the middle third, warps of 1 ms\n\n";
  text += fmt::format("{:<10}{:<26}{:<7}{:>10}{:>8}{:>6}{:>8}{:>12}{:>13}\n", "queue", "schedule", "order",
                      "overhead", "missed", "run", "frames", "throughput", "mtp tr. p50");
  for (const ScheduleBenchRow& row : result.rows)
    text += fmt::format("{:<10}{:<26}{:<7}{:>7} us{:>8}{:>6}{:>8}{:>12.3f}{:>10.1f} ms\n", row.queue,
                        row.schedule, row.order, row.overhead_us, row.missed, row.longest_run, row.eye_frames,
                        row.throughput, row.mtp_translation_p50_ms);
  text += "\ntarget (single): none missed after the load step's first period at a throughput of 0.9\n";
  return text;
}

std::string to_json(const ScheduleBenchResult& result) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const ScheduleBenchRow& row : result.rows)
    rows.push_back(nlohmann::ordered_json{{"queue", row.queue},
                                          {"schedule", row.schedule},
                                          {"order", row.order},
                                          {"overhead_us", row.overhead_us},
                                          {"missed", row.missed},
                                          {"longest_run", row.longest_run},
                                          {"eye_frames", row.eye_frames},
                                          {"throughput", row.throughput},
                                          {"mtp_translation_p50_ms", row.mtp_translation_p50_ms}});
  return nlohmann::ordered_json{{"rows", rows}}.dump(2);
}

}  // namespace brace
