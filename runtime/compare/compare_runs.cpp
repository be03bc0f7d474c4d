#include "runtime/compare/compare_runs.hpp"

#include <algorithm>
#include <fstream>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "runtime/report/csv.hpp"
#include "runtime/report/figures_json.hpp"
#include "runtime/report/run_directory.hpp"
#include "runtime/report/summary.hpp"

namespace brace {

namespace fs = std::filesystem;

namespace {

struct RunFiles {
  fs::path folder;
  Json summary;
  std::vector<std::string> labels;  // of its series; {""} for a single one

  /// The first series' records lie in frames.csv, the others' in frames-LABEL.csv.
  fs::path frames_csv(const std::string& label) const {
    if (label == labels.front()) return folder / "frames.csv";
    return folder / fmt::format("frames-{}.csv", file_part(label));
  }
};

RunFiles open_run(const fs::path& folder) {
  RunFiles run;
  run.folder = folder;
  const fs::path file = folder / "summary.json";
  std::ifstream stream(file);
  if (!stream) {
    throw input_error(
        "{}: is no run directory: it has no summary.json that can be read; accepted: what "
        "`brace run` wrote",
        folder.string());
  }
  run.summary = Json::parse(stream, nullptr, false);
  const bool is_run =
      run.summary.is_object() && run.summary.contains("format") && run.summary["format"] == summary_format;
  if (!is_run) {
    throw input_error("{}: is not the summary of a run; its \"format\" must be \"{}\"", file.string(),
                      summary_format);
  }
  const Json series = run.summary.value("series", Json::array());
  for (const Json& one : series) {
    if (one.is_object()) run.labels.push_back(one.value("label", std::string()));
  }
  if (run.labels.empty()) run.labels.emplace_back();
  return run;
}

bool is_deterministic(const RunFiles& run) {
  const auto flag = run.summary.find("deterministic");
  return flag != run.summary.end() && flag->is_boolean() && flag->get<bool>();
}

std::string text_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

// Leaves of `a` and `b` below `name` that are not the same; a leaf that one does not have is "-".
void add_differences(const std::string& name, const Json& a, const Json& b, std::vector<Difference>& to) {
  if (a == b) return;
  if (!a.is_object() && !b.is_object()) {
    to.push_back({name, text_of(a), text_of(b)});
    return;
  }
  std::set<std::string> keys;
  for (const Json* side : {&a, &b}) {
    if (!side->is_object()) continue;
    for (const auto& [key, ignored] : side->items())
      keys.insert(key);
  }
  for (const std::string& key : keys)
    add_differences(fmt::format("{}.{}", name, key), a.is_object() ? a.value(key, Json("-")) : Json("-"),
                    b.is_object() ? b.value(key, Json("-")) : Json("-"), to);
}

std::vector<Difference> differences_of(const RunFiles& a, const RunFiles& b) {
  std::vector<Difference> differences;
  for (const char* key :
       {"version", "device", "refresh_hz", "resolution_scale", "trace", "clock", "pipeline"})
    add_differences(key, a.summary.value(key, Json("-")), b.summary.value(key, Json("-")), differences);
  return differences;
}

std::vector<std::string> without(std::vector<std::string> labels, const std::vector<std::string>& others) {
  std::erase_if(labels, [&](const std::string& label) {
    return std::find(others.begin(), others.end(), label) != others.end();
  });
  return labels;
}

SeriesComparison compare_series(const fs::path& a, const fs::path& b, const std::string& label,
                                bool deterministic, const CompareOptions& options) {
  try {
    return {label, compare_records(read_frames_csv(a), read_frames_csv(b), deterministic, options)};
  } catch (const Error& error) {
    const std::string message = error.what();
    if (message.starts_with(a.string()) || message.starts_with(b.string())) throw;
    throw Error(error.exit_code(), fmt::format("{} and {}: {}", a.string(), b.string(), message));
  }
}

Json figure_json(const FigureComparison& figure) {
  return {{"figure", figure.figure},
          {"statistic", figure.statistic},
          {"count", figure.pairs.count},
          {"block", figure.pairs.block},
          {"a", real(figure.pairs.a)},
          {"b", real(figure.pairs.b)},
          {"difference", real(figure.pairs.difference)},
          {"interval", {real(figure.pairs.lower), real(figure.pairs.upper)}},
          {"tolerance", real(figure.tolerance)},
          {"verdict", verdict_name(figure.verdict)}};
}

Json series_json(const SeriesComparison& series) {
  Json json = {{"label", series.label},
               {"vsyncs_paired", series.records.vsyncs_paired},
               {"vsyncs_only_a", series.records.vsyncs_only_a},
               {"vsyncs_only_b", series.records.vsyncs_only_b},
               {"figures", Json::array()},
               {"figures_only_a", series.records.only_a},
               {"figures_only_b", series.records.only_b}};
  for (const FigureComparison& figure : series.records.figures)
    json["figures"].push_back(figure_json(figure));
  return json;
}

}  // namespace

bool RunsComparison::passed() const {
  const auto is_worse = [](const FigureComparison& figure) { return figure.verdict == Verdict::worse; };
  return std::none_of(series.begin(), series.end(), [&](const SeriesComparison& one) {
    return std::any_of(one.records.figures.begin(), one.records.figures.end(), is_worse);
  });
}

RunsComparison compare_runs(const fs::path& a, const fs::path& b, const CompareOptions& options) {
  const RunFiles run_a = open_run(a), run_b = open_run(b);
  RunsComparison comparison;
  comparison.deterministic = is_deterministic(run_a) && is_deterministic(run_b);
  comparison.differences = differences_of(run_a, run_b);
  const auto add = [&](const std::string& label_a, const std::string& label_b) {
    comparison.series.push_back(compare_series(run_a.frames_csv(label_a), run_b.frames_csv(label_b), label_a,
                                               comparison.deterministic, options));
  };
  if (run_a.labels.size() == 1 && run_b.labels.size() == 1) {
    add(run_a.labels.front(), run_b.labels.front());
    return comparison;
  }
  comparison.labels_only_a = without(run_a.labels, run_b.labels);
  comparison.labels_only_b = without(run_b.labels, run_a.labels);
  for (const std::string& label : without(run_a.labels, comparison.labels_only_a))
    add(label, label);
  if (comparison.series.empty()) {
    throw input_error("{} has the series {} and {} has {}: none in common", a.string(),
                      fmt::join(run_a.labels, ", "), b.string(), fmt::join(run_b.labels, ", "));
  }
  return comparison;
}

std::string comparison_json(const RunsComparison& comparison, const fs::path& a, const fs::path& b,
                            const CompareOptions& options) {
  Json json = {{"format", "brace-compare-1"},
               {"a", a.string()},
               {"b", b.string()},
               {"passed", comparison.passed()},
               {"unit", comparison.unit},
               {"deterministic", comparison.deterministic},
               {"confidence", options.bootstrap.confidence},
               {"resamples", options.bootstrap.resamples},
               {"seed", options.bootstrap.seed},
               {"differences", Json::array()},
               {"series", Json::array()},
               {"series_only_a", comparison.labels_only_a},
               {"series_only_b", comparison.labels_only_b}};
  for (const Difference& one : comparison.differences)
    json["differences"].push_back({{"name", one.name}, {"a", one.a}, {"b", one.b}});
  for (const SeriesComparison& one : comparison.series)
    json["series"].push_back(series_json(one));
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace brace
