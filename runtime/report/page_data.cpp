#include "runtime/report/page_data.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "base/error.hpp"
#include "runtime/report/base64.hpp"
#include "runtime/report/decimate.hpp"
#include "runtime/report/page.hpp"
#include "runtime/report/text_file.hpp"

namespace brace {

namespace {

constexpr std::size_t missed_slices_max = 60;
constexpr int histogram_bins = 40;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Six digits are more than a screen shows and keep the page small.
double short_number(double value) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10.0, 5.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

// Milliseconds since `origin_ns`, to the microsecond.
double ms_since(std::int64_t origin_ns, std::int64_t ns) {
  return std::round(static_cast<double>(ns - origin_ns) * 1e-3) * 1e-3;
}

using Value = std::function<double(const FrameRecord&)>;

std::vector<double> values_of(std::span<const FrameRecord> records, const Value& value) {
  std::vector<double> values;
  values.reserve(records.size());
  for (const FrameRecord& record : records)
    values.push_back(value(record));
  return values;
}

Json curve(std::span<const FrameRecord> records, const Value& value) {
  const std::int64_t origin_ns = records.empty() ? 0 : records.front().vsync_ns;
  const std::vector<double> t = values_of(
      records, [&](const FrameRecord& r) { return static_cast<double>(r.vsync_ns - origin_ns) * 1e-9; });
  Json points = Json::array();
  for (const CurvePoint& p : decimate(t, values_of(records, value), page_curve_points)) {
    points.push_back({short_number(p.x), real(short_number(p.y))});
  }
  return points;
}

Value ms_of(std::int64_t FrameRecord::*field) {
  return [field](const FrameRecord& r) {
    return r.*field < 0 || !r.pose_valid ? nan : static_cast<double>(r.*field) * 1e-6;
  };
}

// Share of missed vsyncs in at most `missed_slices_max` slices of time: [[middle s, percent, missed, of], …].
Json missed_slices(std::span<const FrameRecord> records) {
  const auto started = std::find_if(records.begin(), records.end(),
                                    [](const FrameRecord& r) { return r.displayed_frame >= 0; });
  const std::span<const FrameRecord> shown(started, records.end());
  const std::size_t per_slice =
      std::max<std::size_t>(1, (shown.size() + missed_slices_max - 1) / missed_slices_max);
  Json slices = Json::array();
  for (std::size_t begin = 0; begin < shown.size(); begin += per_slice) {
    const auto slice = shown.subspan(begin, std::min(per_slice, shown.size() - begin));
    const auto missed =
        std::count_if(slice.begin(), slice.end(), [](const FrameRecord& r) { return r.missed; });
    const double middle_ns = 0.5 * static_cast<double>(slice.front().vsync_ns + slice.back().vsync_ns -
                                                       2 * records.front().vsync_ns);
    slices.push_back({short_number(middle_ns * 1e-9),
                      short_number(100.0 * static_cast<double>(missed) / static_cast<double>(slice.size())),
                      missed, slice.size()});
  }
  return {{"per_slice", per_slice}, {"slices", std::move(slices)}};
}

// The part of a long run that the timeline shows: around the end of its longest stale run.
std::span<const FrameRecord> timeline_part(std::span<const FrameRecord> records) {
  if (records.size() <= page_timeline_vsyncs) return records;
  const auto shorter = [](const FrameRecord& a, const FrameRecord& b) { return a.stale_run < b.stale_run; };
  const auto worst =
      static_cast<std::size_t>(std::max_element(records.begin(), records.end(), shorter) - records.begin());
  const std::size_t half = page_timeline_vsyncs / 2;
  const std::size_t begin = std::min(worst < half ? 0 : worst - half, records.size() - page_timeline_vsyncs);
  return records.subspan(begin, page_timeline_vsyncs);
}

// Spans of work as [start ms, end ms, frame or vsync]: from the jobs, or from the records if there are none.
Json job_spans(const RunSeries& series, std::span<const FrameRecord> part, JobKind kind,
               std::int64_t origin_ns) {
  Json spans = Json::array();
  const auto add = [&](std::int64_t start_ns, std::int64_t end_ns, std::int64_t index) {
    if (start_ns < 0 || end_ns < part.front().vsync_ns - 1'000'000'000 || start_ns > part.back().vsync_ns)
      return;
    spans.push_back({ms_since(origin_ns, start_ns), ms_since(origin_ns, end_ns), index});
  };
  for (const JobRecord& job : series.jobs) {
    if (job.kind == kind) add(job.start_ns, job.end_ns, job.index);
  }
  if (!series.jobs.empty()) return spans;
  std::int64_t last_frame = -1;
  for (const FrameRecord& r : part) {
    if (kind == JobKind::warp && !r.missed) add(r.warp_start_ns, r.warp_done_ns, r.vsync_index);
    if (kind == JobKind::cast && r.displayed_frame != last_frame) {
      add(r.render_start_ns, r.render_done_ns, r.displayed_frame);
    }
    last_frame = r.displayed_frame;
  }
  return spans;
}

Json timeline(const RunSeries& series) {
  Json json = {{"total", series.records.size()}, {"vsyncs", Json::array()}};
  if (series.records.empty()) return json;
  const std::span<const FrameRecord> part = timeline_part(series.records);
  const std::int64_t origin_ns = series.records.front().vsync_ns;
  for (const FrameRecord& r : part) {
    const bool lit = r.photon_first_row_ns >= 0;
    json["vsyncs"].push_back({r.vsync_index, ms_since(origin_ns, r.vsync_ns),
                              r.missed && r.displayed_frame >= 0 ? 1 : 0, r.displayed_frame,
                              lit ? Json(ms_since(origin_ns, r.photon_first_row_ns)) : Json(),
                              lit ? Json(ms_since(origin_ns, r.photon_last_row_ns)) : Json()});
  }
  json["casts"] = job_spans(series, part, JobKind::cast, origin_ns);
  json["warps"] = job_spans(series, part, JobKind::warp, origin_ns);
  json["updates"] = job_spans(series, part, JobKind::update, origin_ns);
  return json;
}

Json pictures(const RunSeries& series, const std::filesystem::path& folder) {
  Json json = Json::array();
  const std::size_t count = std::min(series.pictures.size(), page_picture_vsyncs);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t last = series.pictures.size() - 1;
    const EyePicture& picture = series.pictures[count < 2 ? 0 : i * last / (count - 1)];
    const auto embedded = [&](const std::filesystem::path& png) {
      return "data:image/png;base64," + base64(read_text_file(folder / png));
    };
    json.push_back({{"vsync", picture.vsync_index},
                    {"left", embedded(picture.left_png)},
                    {"right", embedded(picture.right_png)}});
  }
  return json;
}

// {"from", "width", "share": [[percent per bin] per group], "beyond": [percent per group]}
Json histogram(const std::vector<std::vector<double>>& groups) {
  const Histogram bins = histogram_of(groups, histogram_bins);
  Json json = {{"from", short_number(bins.from)},
               {"width", bins.width},
               {"share", Json::array()},
               {"beyond", Json::array()}};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto values =
        std::count_if(groups[g].begin(), groups[g].end(), [](double v) { return !std::isnan(v); });
    const auto percent = [&](std::int64_t count) {
      return values == 0 ? 0.0
                         : short_number(100.0 * static_cast<double>(count) / static_cast<double>(values));
    };
    Json share = Json::array();
    for (const std::int64_t count : bins.counts[g])
      share.push_back(percent(count));
    json["share"].push_back(std::move(share));
    json["beyond"].push_back(percent(bins.beyond[g]));
  }
  return json;
}

Json series_data(const RunSeries& series, const std::filesystem::path& pictures_folder) {
  const double degrees = 180.0 / std::numbers::pi;
  Json json;
  json["label"] = series.label;
  json["pipeline"] = pipeline_json(series);
  json["left_out"] = left_out_json(series);
  json["figures"] = figures_json(series);
  json["dssim_left"] = curve(series.records, [](const FrameRecord& r) { return r.dssim_left; });
  json["dssim_right"] = curve(series.records, [](const FrameRecord& r) { return r.dssim_right; });
  json["angle_deg"] =
      curve(series.records, [=](const FrameRecord& r) { return r.angular_error_rad * degrees; });
  json["position_mm"] = curve(series.records, [](const FrameRecord& r) { return r.position_error_m * 1e3; });
  json["missed"] = missed_slices(series.records);
  json["timeline"] = timeline(series);
  json["pictures"] = pictures(series, pictures_folder);
  json["pictures_total"] = series.pictures.size();
  return json;
}

}  // namespace

Json page_data(const ReportInput& input, const std::filesystem::path& pictures_folder) {
  BRACE_CHECK(!input.series.empty());
  Json json = {{"version", input.version},
               {"device", input.device},
               {"refresh_hz", real(input.refresh_hz)},
               {"resolution_scale", real(input.resolution_scale)},
               {"trace", input.trace},
               {"clock", clock_json(input.clock)},
               {"deterministic", input.deterministic},
               {"facts", facts_json(input.facts)},
               {"failure", input.failure},
               {"host", host_json(input.host)},
               {"session", input.session_toml},
               {"curve_points", page_curve_points}};
  json["tables"] = Json::array();
  for (const ReportTable& table : input.tables) {
    json["tables"].push_back(
        {{"title", table.title}, {"note", table.note}, {"columns", table.columns}, {"rows", table.rows}});
  }
  std::vector<std::vector<double>> rotation, translation, age;
  json["series"] = Json::array();
  for (const RunSeries& series : input.series) {
    json["series"].push_back(series_data(series, pictures_folder));
    rotation.push_back(values_of(series.records, ms_of(&FrameRecord::mtp_rotation_ns)));
    translation.push_back(values_of(series.records, ms_of(&FrameRecord::mtp_translation_ns)));
    age.push_back(values_of(series.records, ms_of(&FrameRecord::frame_age_ns)));
  }
  rotation.insert(rotation.end(), translation.begin(), translation.end());
  json["mtp"] = histogram(rotation);  // rotation of every series, then translation of every series
  json["age"] = histogram(age);
  return json;
}

}  // namespace brace
