#include "runtime/report/summary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "runtime/metrics/pacing.hpp"
#include "runtime/report/figures_json.hpp"
#include "runtime/timeline/gpu_time.hpp"

namespace brace {

namespace {

Json distribution_json(const Distribution& d) {
  if (d.count == 0) {
    return {{"mean", nullptr}, {"p50", nullptr}, {"p95", nullptr}, {"p99", nullptr}, {"max", nullptr}};
  }
  return {{"mean", real(d.mean)},
          {"p50", real(d.p50)},
          {"p95", real(d.p95)},
          {"p99", real(d.p99)},
          {"max", real(d.max)}};
}

std::vector<double> measured(std::span<const FrameRecord> records, double FrameRecord::*field) {
  std::vector<double> values;
  for (const FrameRecord& record : records) {
    if (!std::isnan(record.*field)) values.push_back(record.*field);
  }
  return values;
}

// Values of both eyes together at the top, each eye's own below.
Json eyes_json(std::span<const FrameRecord> records, double FrameRecord::*of_left,
               double FrameRecord::*of_right) {
  const std::vector<double> left = measured(records, of_left);
  const std::vector<double> right = measured(records, of_right);
  std::vector<double> both = left;
  both.insert(both.end(), right.begin(), right.end());
  Json json = distribution_json(distribution_of(both));
  json["count"] = both.size();
  json["left"] = distribution_json(distribution_of(left));
  json["right"] = distribution_json(distribution_of(right));
  return json;
}

// When eye frames were done: from the jobs, where frames that no one ever saw are too.
std::vector<std::int64_t> frames_done_ns(const RunSeries& series) {
  std::vector<std::int64_t> done;
  for (const JobRecord& job : series.jobs) {
    if (job.kind == JobKind::cast && job.end_ns >= 0 && job.ends_frame) done.push_back(job.end_ns);
  }
  if (series.jobs.empty()) {
    std::int64_t last_frame = -1;
    for (const FrameRecord& record : series.records) {
      if (record.displayed_frame < 0 || record.displayed_frame == last_frame) continue;
      last_frame = record.displayed_frame;
      if (record.render_done_ns >= 0) done.push_back(record.render_done_ns);
    }
  }
  std::sort(done.begin(), done.end());
  return done;
}

}  // namespace

Json real(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json pipeline_json(const RunSeries& series) {
  Json json = Json::object();
  for (const StageChoice& choice : series.pipeline)
    json[choice.family] = choice.stage;
  return json;
}

Json left_out_json(const RunSeries& series) {
  Json json = Json::array();
  for (const LeftOut& one : series.left_out)
    json.push_back({{"stage", one.stage}, {"reason", one.reason}});
  return json;
}

Json faults_json(const RunSeries& series) {
  Json json = Json::array();
  for (const WatchdogFault& fault : series.faults) {
    json.push_back({{"stage", fault.stage},
                    {"fault", fault.clause},
                    {"count", fault.count},
                    {"first_frame", fault.first_frame}});
  }
  return json;
}

Json facts_json(std::span<const Fact> facts) {
  Json json = Json::object();
  for (const Fact& fact : facts)
    json[fact.name] = fact.value;
  return json;
}

Json clock_json(const ClockInfo& clock) {
  return {{"mode", clock.mode},
          {"queue", clock.queue},
          {"cost", clock.cost},
          {"cost_resolution", clock.cost_resolution}};
}

Json host_json(const HostFigures& host) {
  Json json = {
      {"wall_s", real(host.wall_s)}, {"cpu_s", real(host.cpu_s)}, {"peak_rss_bytes", host.peak_rss_bytes}};
  for (const Fact& fact : host.facts)
    json[fact.name] = fact.value;
  return json;
}

Json figures_json(const RunSeries& series) {
  const PacingFigures pacing = series.figures ? *series.figures : pacing_figures(series.records);
  const FrameRate rate = series.rate ? *series.rate : frame_rate(frames_done_ns(series));
  Json json;
  json["vsyncs"] = pacing.vsyncs;
  json["startup_vsyncs"] = pacing.startup_vsyncs;
  json["gap_vsyncs"] = pacing.gap_vsyncs;
  json["missed_vsyncs"] = pacing.missed_vsyncs;
  json["missed_ratio"] = real(pacing.missed_ratio);
  json["longest_stale_run"] = pacing.longest_stale_run;
  json["stale_runs"] = pacing.stale_runs;
  json["mtp_ms"] = {{"rotation", distribution_json(pacing.mtp_rotation_ms)},
                    {"translation", distribution_json(pacing.mtp_translation_ms)}};
  json["frame_age_ms"] = distribution_json(pacing.frame_age_ms);
  json["frames_rendered"] = rate.frames;
  json["frames_shown"] = pacing.frames_shown;
  json["fps_avg"] = real(rate.fps_avg);
  json["fps_1pct_low"] = real(rate.fps_1pct_low);
  json["fps_1pct_low_mean"] = real(rate.fps_1pct_low_mean);
  if (!series.jobs.empty()) {
    const GpuTime gpu = gpu_time(series.jobs);
    json["gpu_ms"] = {{"frame", real(gpu.frame_ms())},
                      {"cast", real(gpu.cast_ms)},
                      {"update", real(gpu.update_ms)},
                      {"warp", real(gpu.warp_ms)}};
  }
  if (series.stereo_layer_mib) json["stereo_layer_mib"] = real(*series.stereo_layer_mib);
  json["dssim"] = eyes_json(series.records, &FrameRecord::dssim_left, &FrameRecord::dssim_right);
  json["weighted_rmse"] =
      eyes_json(series.records, &FrameRecord::weighted_rmse_left, &FrameRecord::weighted_rmse_right);
  std::vector<double> gaze_error_deg = measured(series.records, &FrameRecord::gaze_error_rad);
  for (double& value : gaze_error_deg)
    value *= 180.0 / std::numbers::pi;
  json["gaze_error_deg"] = distribution_json(distribution_of(gaze_error_deg));
  json["angular_error_deg"] = distribution_json(pacing.angular_error_deg);
  json["position_error_mm"] = distribution_json(pacing.position_error_mm);
  json["animation_error_ms"] = distribution_json(pacing.animation_error_ms);
  json["judder_rms_deg"] = real(pacing.judder_rms_deg);
  return json;
}

std::string summary_json(const ReportInput& input) {
  BRACE_CHECK(!input.series.empty());
  const RunSeries& first = input.series.front();
  Json json;
  json["format"] = summary_format;
  json["version"] = input.version;
  json["device"] = input.device;
  json["refresh_hz"] = real(input.refresh_hz);
  json["resolution_scale"] = real(input.resolution_scale);
  json["trace"] = input.trace;
  json["clock"] = clock_json(input.clock);
  json["deterministic"] = input.deterministic;
  json["complete"] = input.failure.empty();
  if (!input.failure.empty()) json["failure"] = input.failure;
  if (!input.watchdog.empty()) json["watchdog_level"] = input.watchdog;
  const auto add_series = [&](Json& to, const RunSeries& series) {
    if (!series.label.empty()) to["label"] = series.label;
    to["pipeline"] = pipeline_json(series);
    to.update(figures_json(series));
    to["left_out"] = left_out_json(series);
    if (!input.watchdog.empty()) to["watchdog"] = faults_json(series);
  };
  add_series(json, first);
  if (input.series.size() > 1) {
    for (const RunSeries& series : input.series) {
      Json one = Json::object();
      add_series(one, series);
      json["series"].push_back(std::move(one));
    }
  }
  json["facts"] = facts_json(input.facts);
  json["host"] = host_json(input.host);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace brace
