#include "runtime/sweep/figures.hpp"

#include <array>
#include <limits>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "runtime/metrics/pacing.hpp"
#include "runtime/report/text_file.hpp"
#include "runtime/timeline/costs_csv.hpp"

namespace brace {

namespace {

using Json = nlohmann::json;
using Figure = std::optional<double>;

struct SummaryFigure {
  const char* name;
  const char* pointer;  // into summary.json
};

constexpr std::array<SummaryFigure, 31> summary_figures{{
    {"vsyncs", "/vsyncs"},
    {"missed_vsyncs", "/missed_vsyncs"},
    {"missed_ratio", "/missed_ratio"},
    {"longest_stale_run", "/longest_stale_run"},
    {"frames_rendered", "/frames_rendered"},
    {"fps_avg", "/fps_avg"},
    {"fps_1pct_low", "/fps_1pct_low"},
    {"mtp_rotation_ms_p50", "/mtp_ms/rotation/p50"},
    {"mtp_rotation_ms_p95", "/mtp_ms/rotation/p95"},
    {"mtp_rotation_ms_p99", "/mtp_ms/rotation/p99"},
    {"mtp_rotation_ms_max", "/mtp_ms/rotation/max"},
    {"mtp_translation_ms_p50", "/mtp_ms/translation/p50"},
    {"mtp_translation_ms_p95", "/mtp_ms/translation/p95"},
    {"mtp_translation_ms_p99", "/mtp_ms/translation/p99"},
    {"mtp_translation_ms_max", "/mtp_ms/translation/max"},
    {"frame_age_ms_p50", "/frame_age_ms/p50"},
    {"frame_age_ms_p95", "/frame_age_ms/p95"},
    {"frame_age_ms_p99", "/frame_age_ms/p99"},
    {"gpu_ms_frame", "/gpu_ms/frame"},
    {"dssim_mean", "/dssim/mean"},
    {"dssim_p95", "/dssim/p95"},
    {"dssim_max", "/dssim/max"},
    {"angular_error_deg_p50", "/angular_error_deg/p50"},
    {"angular_error_deg_p95", "/angular_error_deg/p95"},
    {"angular_error_deg_max", "/angular_error_deg/max"},
    {"position_error_mm_p50", "/position_error_mm/p50"},
    {"position_error_mm_max", "/position_error_mm/max"},
    {"stereo_layer_mib", "/stereo_layer_mib"},
    {"weighted_rmse_mean", "/weighted_rmse/mean"},
    {"weighted_rmse_max", "/weighted_rmse/max"},
    {"gaze_error_deg_p95", "/gaze_error_deg/p95"},
}};

struct WorkFigure {
  const char* name;
  JobKind kind;
  std::uint64_t WorkCounts::*count;
};

constexpr std::array<WorkFigure, 6> work_figures{{
    {"rays", JobKind::cast, &WorkCounts::rays},
    {"samples", JobKind::cast, &WorkCounts::samples},
    {"skip_steps", JobKind::cast, &WorkCounts::skip_steps},
    {"shading_fetches", JobKind::cast, &WorkCounts::shading_fetches},
    {"warp_texels", JobKind::warp, &WorkCounts::texels},
    {"update_bytes", JobKind::update, &WorkCounts::bytes},
}};

constexpr std::array<JobKind, 3> job_kinds{JobKind::cast, JobKind::warp, JobKind::update};

Figure figure_of(const Json& value) {
  if (value.is_number()) return value.get<double>();
  if (value == "inf") return std::numeric_limits<double>::infinity();
  if (value == "-inf") return -std::numeric_limits<double>::infinity();
  return std::nullopt;
}

Json read_summary(const std::filesystem::path& run) {
  const std::filesystem::path file = run / "summary.json";
  Json summary = Json::parse(read_text_file(file), nullptr, false);
  if (!summary.is_object()) throw device_error("{}: is not JSON", file.string());
  return summary;
}

void append_durations(std::vector<Figure>& figures, const std::vector<JobRecord>& jobs, JobKind kind) {
  std::vector<double> ms;
  for (const JobRecord& job : jobs) {
    if (job.kind == kind && job.end_ns >= 0) ms.push_back(static_cast<double>(job.cost_ns) * 1e-6);
  }
  const bool none = ms.empty();
  const Distribution d = distribution_of(std::move(ms));
  for (const double value : {d.mean, d.p50, d.p95, d.p99, d.max})
    figures.push_back(none ? Figure{} : value);
}

/// What a watchdog counted; none if nobody watched.
Figure watchdog_faults(const Json& summary) {
  const auto found = summary.find("watchdog");
  if (found == summary.end()) return {};
  double faults = 0;
  for (const Json& fault : *found)
    faults += fault.value("count", 0.0);
  return faults;
}

Figure mean_work(const std::vector<JobRecord>& jobs, const WorkFigure& figure) {
  double sum = 0, count = 0;
  for (const JobRecord& job : jobs) {
    if (job.kind != figure.kind || job.end_ns < 0) continue;
    sum += static_cast<double>(job.work.*figure.count);
    count += 1;
  }
  return count == 0 ? Figure{} : sum / count;
}

}  // namespace

const std::vector<std::string>& sweep_figure_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const SummaryFigure& figure : summary_figures)
      all.emplace_back(figure.name);
    for (const JobKind kind : job_kinds) {
      for (const char* part : {"mean", "p50", "p95", "p99", "max"})
        all.push_back(std::string(name_of(kind)) + "_ms_" + part);
    }
    for (const WorkFigure& figure : work_figures)
      all.emplace_back(figure.name);
    all.emplace_back("watchdog_faults");
    return all;
  }();
  return names;
}

std::vector<std::optional<double>> read_sweep_figures(const std::filesystem::path& run) {
  const Json summary = read_summary(run);
  const std::vector<JobRecord> jobs = read_costs_csv(run / "costs.csv");
  std::vector<Figure> figures;
  for (const SummaryFigure& figure : summary_figures)
    figures.push_back(figure_of(summary.value(Json::json_pointer(figure.pointer), Json())));
  for (const JobKind kind : job_kinds)
    append_durations(figures, jobs, kind);
  for (const WorkFigure& figure : work_figures)
    figures.push_back(mean_work(jobs, figure));
  figures.push_back(watchdog_faults(summary));
  return figures;
}

SweepHostFigures read_sweep_host_figures(const std::filesystem::path& run) {
  const Json summary = read_summary(run);
  const auto value = [&](const char* pointer) { return summary.value(Json::json_pointer(pointer), 0.0); };
  return {value("/host/wall_s"), value("/host/cpu_s"), value("/host/peak_rss_bytes")};
}

}  // namespace brace
