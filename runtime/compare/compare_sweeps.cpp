#include "runtime/compare/compare_sweeps.hpp"

#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.hpp"
#include "runtime/sweep/database.hpp"

namespace brace {

namespace {

struct SweepFigure {
  const char* name;
  const char* statistic;
  const char* column;
  Tolerance tolerance;  // unless the user asks for another
};

constexpr std::array<SweepFigure, 6> sweep_figures = {{
    {"missed_ratio", "mean", "missed_ratio", {0.005, 0}},
    {"mtp_rotation_ms", "p99", "mtp_rotation_ms_p99", {0.1, 0.01}},
    {"mtp_translation_ms", "p99", "mtp_translation_ms_p99", {0.1, 0.01}},
    {"frame_age_ms", "p99", "frame_age_ms_p99", {0.1, 0.01}},
    {"dssim", "mean", "dssim_mean", {0.001, 0.01}},
    {"samples", "mean", "samples", {0, 0.01}},
}};

std::filesystem::path results_of(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "results.sqlite";
  if (std::filesystem::exists(file)) return file;
  throw input_error("{}: is no sweep's folder, it has no results.sqlite; accepted: two sweeps, or two runs",
                    folder.string());
}

/// The keys that vary: what stands between `message` and the first figure.
std::vector<std::string> varied_keys(Database& database, const char* schema) {
  std::vector<std::string> keys;
  Statement columns(database,
                    fmt::format("select name from pragma_table_info('results', '{}') order by cid", schema));
  bool between = false;
  while (columns.step()) {
    const std::string name = columns.text(0);
    if (name == "vsyncs") break;
    if (between) keys.push_back(name);
    between = between || name == "message";
  }
  return keys;
}

std::int64_t count_of(Database& database, const std::string& sql) {
  Statement statement(database, "select count(*) from " + sql);
  statement.step();
  return statement.integer(0);
}

/// "from … where …": pairs of rows a and b.
std::string pairs_sql(const std::vector<std::string>& keys) {
  std::string sql = "main.results a join other.results b on a.repeat is b.repeat";
  for (const std::string& key : keys)
    sql += fmt::format(" and a.{0} is b.{0}", sql_name(key));
  return sql + " where a.status = 'done' and b.status = 'done'";
}

FigureComparison compare_figure(Database& database, const SweepFigure& figure, const std::string& pairs,
                                bool deterministic, const CompareOptions& options) {
  std::vector<double> a, b;
  Statement values(database,
                   fmt::format("select a.{0}, b.{0} from {1} and a.{0} is not null and b.{0} is not null "
                               "order by a.point, a.repeat",
                               sql_name(figure.column), pairs));
  while (values.step()) {
    a.push_back(std::stod(values.value_text(0)));
    b.push_back(std::stod(values.value_text(1)));
  }
  FigureComparison comparison{figure.name, figure.statistic, {}, 0, Verdict::same};
  comparison.pairs = paired_difference(a, b, {}, options.bootstrap);
  comparison.tolerance = tolerance_of(options.tolerances, figure.name, figure.statistic, figure.tolerance)
                             .of(comparison.pairs.a);
  comparison.verdict = verdict_of(comparison.pairs, comparison.tolerance, deterministic);
  return comparison;
}

}  // namespace

bool is_sweep(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::exists(folder / "results.sqlite", ignored);
}

RunsComparison compare_sweeps(const std::filesystem::path& a, const std::filesystem::path& b,
                              const CompareOptions& options) {
  Database database(results_of(a));
  Statement attach(database, "attach ? as other");
  attach.bind(1, results_of(b).string());
  attach.step();
  attach.reset();
  const std::vector<std::string> keys = varied_keys(database, "main"),
                                 keys_b = varied_keys(database, "other");
  if (keys != keys_b) {
    throw input_error("the sweeps vary other keys: {} in {}, {} in {}", fmt::join(keys, ", "), a.string(),
                      fmt::join(keys_b, ", "), b.string());
  }
  const std::string pairs = pairs_sql(keys);
  RunsComparison comparison;
  comparison.unit = "points";
  comparison.deterministic = count_of(database, "main.points where session like '%cost = %measured%'") == 0 &&
                             count_of(database, "other.points where session like '%cost = %measured%'") == 0;
  SeriesComparison series;
  RecordsComparison& records = series.records;
  const auto number = [&](const std::string& sql) {
    return static_cast<std::size_t>(count_of(database, sql));
  };
  records.vsyncs_paired = number(pairs);
  records.vsyncs_only_a = number("main.results where status = 'done'") - records.vsyncs_paired;
  records.vsyncs_only_b = number("other.results where status = 'done'") - records.vsyncs_paired;
  if (records.vsyncs_paired == 0)
    throw input_error("{} and {} have no finished point in common", a.string(), b.string());
  for (const SweepFigure& figure : sweep_figures) {
    FigureComparison one = compare_figure(database, figure, pairs, comparison.deterministic, options);
    if (one.pairs.count > 0) records.figures.push_back(std::move(one));
  }
  comparison.series.push_back(std::move(series));
  return comparison;
}

}  // namespace brace
