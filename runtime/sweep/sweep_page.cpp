#include "runtime/sweep/sweep_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "runtime/report/page.hpp"
#include "runtime/report/text_file.hpp"
#include "runtime/sweep/work_precision.hpp"

namespace brace {

namespace {

using PageJson = nlohmann::ordered_json;

struct Axis {
  const char *figure, *label, *unit;
};
constexpr std::array works{Axis{"cast_ms_p50", "cast, p50", "ms"}, Axis{"cast_ms_p95", "cast, p95", "ms"},
                           Axis{"samples", "samples per eye frame", ""},
                           Axis{"rays", "rays per eye frame", ""}};
constexpr std::array errors{Axis{"dssim_mean", "DSSIM, mean", ""}, Axis{"dssim_p95", "DSSIM, p95", ""},
                            Axis{"dssim_max", "DSSIM, max", ""}};
/// What can be drawn along the knob; the first two are derived here.
constexpr std::array along{Axis{"second_eye_saved", "time saved on the second eye, V", ""},
                           Axis{"second_eye_ms", "time of the second eye", "ms"},
                           Axis{"cast_ms_p50", "cast, p50", "ms"},
                           Axis{"samples", "samples per eye frame", ""},
                           Axis{"shading_fetches", "shading fetches per eye frame", ""},
                           Axis{"rays", "rays per eye frame", ""},
                           Axis{"stereo_layer_mib", "memory of the stereo stage's layers", "MiB"},
                           Axis{"dssim_mean", "DSSIM, mean", ""}};
constexpr double period_ms = 1e3 / 90.0;

/// All repetitions of a point.
struct PagePoint {
  std::int64_t point = 0;
  std::size_t method = 0;  // of methods_of
  std::string knob, status, message;
  std::vector<std::string> settings;      // in the order of the sweep's keys
  std::map<std::string, double> figures;  // NaN where none
};

const SweepValue& value_at(const SweepPoint& point, const std::string& key) {
  const auto found = std::find_if(point.settings.rbegin(), point.settings.rend(),
                                  [&](const SweepSetting& setting) { return setting.key == key; });
  static const SweepValue none = std::string();
  return found == point.settings.rend() ? none : found->value;
}

std::string method_of(const SweepFile& sweep, const SweepPoint& point, const std::string& knob) {
  std::string method;
  for (const std::string& key : sweep.keys) {
    const std::string text = to_text(value_at(point, key));
    if (key == knob || text.empty()) continue;
    const std::string name = key.substr(key.rfind('.') + 1);
    method += (method.empty() ? "" : ", ") + name + " " + text;
  }
  return method.empty() ? "all points" : method;
}

/// What the points' methods are called, in the order in which they first appear; `points` get theirs.
std::vector<std::string> name_methods(const SweepFile& sweep, const std::string& knob,
                                      std::vector<PagePoint>& points) {
  std::vector<std::string> names;
  std::map<std::string, std::size_t> known;
  for (PagePoint& point : points) {
    const std::string name = method_of(sweep, sweep.points[static_cast<std::size_t>(point.point - 1)], knob);
    const auto [found, is_new] = known.emplace(name, names.size());
    if (is_new) names.push_back(name);
    point.method = found->second;
  }
  return names;
}

/// done where one repetition is, else what the last one came to.
std::vector<PagePoint> gather(const SweepFile& sweep, const std::vector<SweepRow>& rows,
                              const std::string& knob) {
  std::map<std::int64_t, std::vector<const SweepRow*>> rows_of;
  for (const SweepRow& row : rows)
    rows_of[row.run.point].push_back(&row);
  std::vector<PagePoint> points;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    PagePoint point;
    point.point = static_cast<std::int64_t>(i + 1);
    if (!knob.empty()) point.knob = to_text(value_at(sweep.points[i], knob));
    for (const std::string& key : sweep.keys)
      point.settings.push_back(to_text(value_at(sweep.points[i], key)));
    std::vector<std::vector<std::optional<double>>> figures(sweep_figure_names().size());
    for (const SweepRow* row : rows_of[point.point]) {
      if (point.status != "done") point.status = row->status;
      if (row->status != "done") {
        point.message = row->message;
        continue;
      }
      for (std::size_t f = 0; f < figures.size(); ++f)
        figures[f].push_back(row->figures[f]);
    }
    for (std::size_t f = 0; f < figures.size(); ++f)
      point.figures[sweep_figure_names()[f]] = median_of_present(figures[f]);
    points.push_back(std::move(point));
  }
  return points;
}

/// Where two passes are among the sweep's stereo stages: what each point's pair of eyes takes beyond the
/// first of them, and V = 1 - (T_pair - T_eye) / T_eye (Buchacher 2017, eq. 23), T_eye half of two passes
/// with otherwise the same settings.
void derive_second_eye(const SweepFile& sweep, std::vector<PagePoint>& points) {
  const auto key = std::find(sweep.keys.begin(), sweep.keys.end(), "pipeline.stereo");
  const auto at = static_cast<std::size_t>(key - sweep.keys.begin());
  const auto others = [&](const PagePoint& point) {
    std::vector<std::string> settings = point.settings;
    settings[at].clear();
    return settings;
  };
  for (PagePoint& point : points) {
    point.figures["second_eye_ms"] = point.figures["second_eye_saved"] =
        std::numeric_limits<double>::quiet_NaN();
    if (key == sweep.keys.end() || point.settings[at] == "two_pass") continue;
    for (const PagePoint& twice : points) {
      if (twice.settings[at] != "two_pass" || others(twice) != others(point)) continue;
      const double eye_ms = 0.5 * twice.figures.at("cast_ms_mean");
      const double second_ms = point.figures.at("cast_ms_mean") - eye_ms;
      point.figures["second_eye_ms"] = second_ms;
      point.figures["second_eye_saved"] = 1.0 - second_ms / eye_ms;
    }
  }
}

PageJson number(double value) {
  return std::isfinite(value) ? PageJson(value) : PageJson(nullptr);
}

WorkErrorPoint place(const PagePoint& point, const Axis& work, const Axis& error) {
  return {point.figures.at(work.figure), point.figures.at(error.figure)};
}

/// Of one choice of axes: which points are on the front, and what each method needs for the error.
PageJson pair_json(const std::vector<PagePoint>& points, std::size_t methods, const Axis& work,
                   const Axis& error) {
  std::vector<WorkErrorPoint> places;
  std::vector<std::vector<WorkErrorPoint>> of_method(methods);
  for (const PagePoint& point : points) {
    places.push_back(place(point, work, error));
    of_method[point.method].push_back(places.back());
  }
  PageJson pair = {{"front", PageJson::array()}, {"reach", PageJson::array()}};
  const std::vector<bool> front = pareto_front(places);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (front[i]) pair["front"].push_back(i);
  for (const std::vector<WorkErrorPoint>& own : of_method) {
    const std::optional<double> reached = work_to_reach(own, sweep_page_error);
    pair["reach"].push_back(reached ? number(*reached) : PageJson(nullptr));
  }
  return pair;
}

/// Whether cast and warp fit into a period of 90 Hz at their 99th percentiles.
bool holds_90_hz(const PagePoint& point) {
  const double warp_ms = point.figures.at("warp_ms_p99");
  return point.figures.at("cast_ms_p99") + (std::isnan(warp_ms) ? 0.0 : warp_ms) <= period_ms;
}

/// Of each method the point of least error that holds 90 Hz; null where none does.
PageJson best_json(const std::vector<PagePoint>& points, std::size_t methods) {
  std::vector<const PagePoint*> found(methods, nullptr);
  for (const PagePoint& point : points) {
    if (!holds_90_hz(point) || std::isnan(point.figures.at("dssim_mean"))) continue;
    const PagePoint*& best = found[point.method];
    if (best == nullptr || point.figures.at("dssim_mean") < best->figures.at("dssim_mean")) best = &point;
  }
  PageJson json = PageJson::array();
  for (const PagePoint* best : found) {
    json.push_back(best == nullptr
                       ? PageJson(nullptr)
                       : PageJson{{"error", best->figures.at("dssim_mean")}, {"knob", best->knob}});
  }
  return json;
}

PageJson axis_json(const Axis& axis) {
  return {{"figure", axis.figure}, {"label", axis.label}, {"unit", axis.unit}};
}

PageJson page_json(const SweepFile& sweep, const std::vector<SweepRow>& rows, const std::string& version) {
  const std::string knob = knob_of(sweep);
  std::vector<PagePoint> points = gather(sweep, rows, knob);
  derive_second_eye(sweep, points);
  const std::vector<std::string> methods = name_methods(sweep, knob, points);
  PageJson json = {{"version", version},
                   {"sweep", sweep.file.filename().string()},
                   {"session", sweep.session.filename().string()},
                   {"repeat", sweep.repeat},
                   {"knob", knob},
                   {"keys", sweep.keys},
                   {"methods", methods},
                   {"reach_error", sweep_page_error}};
  for (const Axis& work : works)
    json["works"].push_back(axis_json(work));
  for (const Axis& error : errors)
    json["errors"].push_back(axis_json(error));
  json["along"] = PageJson::array();
  for (const Axis& axis : along) {
    const auto has = [&](const PagePoint& point) { return !std::isnan(point.figures.at(axis.figure)); };
    if (!knob.empty() && std::any_of(points.begin(), points.end(), has))
      json["along"].push_back(axis_json(axis));
  }
  json["points"] = PageJson::array();
  for (const PagePoint& point : points) {
    PageJson figures = PageJson::object();
    for (const auto& [name, value] : point.figures)
      figures[name] = number(value);
    json["points"].push_back({{"point", point.point},
                              {"method", point.method},
                              {"knob", point.knob},
                              {"status", point.status},
                              {"message", point.message},
                              {"settings", point.settings},
                              {"holds_90_hz", holds_90_hz(point)},
                              {"figures", std::move(figures)}});
  }
  json["best_at_90_hz"] = best_json(points, methods.size());
  for (const Axis& work : works)
    for (const Axis& error : errors)
      json["pairs"][std::string(work.figure) + "|" + error.figure] =
          pair_json(points, methods.size(), work, error);
  return json;
}

}  // namespace

std::string knob_of(const SweepFile& sweep) {
  if (!sweep.knob.empty()) return sweep.knob;
  for (auto key = sweep.keys.rbegin(); key != sweep.keys.rend(); ++key) {
    std::set<std::string> values;
    bool numbers = true;
    for (const SweepPoint& point : sweep.points) {
      const SweepValue& value = value_at(point, *key);
      numbers = numbers && !std::holds_alternative<std::string>(value);
      values.insert(to_text(value));
    }
    if (numbers && values.size() > 1) return *key;
  }
  return "";
}

void write_sweep_page(const std::filesystem::path& file, const SweepFile& sweep,
                      const std::vector<SweepRow>& rows, const std::string& version,
                      const std::filesystem::path& page_folder) {
  const auto text = [&](const char* name) { return read_text_file(page_folder / name); };
  write_template(file, page_folder / "sweep.html",
                 {{"head", page_head(page_folder, "Brace sweep")},
                  {"chart_library", text("chart.min.js")},
                  {"charts", text("charts.js")},
                  {"script", text("sweep.js")},
                  {"data", script_safe(page_json(sweep, rows, version)
                                           .dump(-1, ' ', false, PageJson::error_handler_t::replace))}});
}

}  // namespace brace
