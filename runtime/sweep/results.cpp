#include "runtime/sweep/results.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/report/output_file.hpp"

namespace brace {

namespace {

constexpr const char* sweep_format = "brace-sweep-1";
constexpr int run_columns = 7;  // point … message

/// Columns between the run's own and the figures' are named by session keys, which have a dot: no name is
/// twice.
std::string column_list(const std::vector<std::string>& names, const char* type) {
  std::string list;
  for (const std::string& name : names)
    list += ", " + sql_name(name) + type;
  return list;
}

const SweepValue* value_of(const SweepPoint& point, const std::string& key) {
  const auto found = std::find_if(point.settings.rbegin(), point.settings.rend(),
                                  [&](const SweepSetting& setting) { return setting.key == key; });
  return found == point.settings.rend() ? nullptr : &found->value;
}

void bind_value(Statement& statement, int parameter, const SweepValue* value) {
  if (value == nullptr) {
    statement.bind_null(parameter);
  } else {
    std::visit([&](const auto& concrete) { statement.bind(parameter, concrete); }, *value);
  }
}

std::string parameters(std::size_t count) {
  std::string list = "?";
  for (std::size_t i = 1; i < count; ++i)
    list += ",?";
  return list;
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string meta_value(Database& database, const char* key) {
  Statement select(database, "SELECT value FROM meta WHERE key = ?");
  select.bind(1, std::string(key));
  return select.step() ? select.text(0) : std::string();
}

bool has_tables(Database& database) {
  Statement select(database, "SELECT count(*) FROM sqlite_master");
  return select.step() && select.integer(0) > 0;
}

bool has_meta(Database& database) {
  Statement select(database, "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = 'meta'");
  return select.step() && select.integer(0) > 0;
}

}  // namespace

const char* name_of(SweepOutcome::Status status) {
  switch (status) {
    case SweepOutcome::Status::pending:
      return "pending";
    case SweepOutcome::Status::done:
      return "done";
    case SweepOutcome::Status::failed:
      return "failed";
    case SweepOutcome::Status::crashed:
      return "crashed";
  }
  return "";
}

SweepResults::SweepResults(const std::filesystem::path& file, const SweepFile& sweep,
                           const std::vector<PlannedPoint>& points, const std::string& version)
    : database_(file), keys_(sweep.keys) {
  if (has_tables(database_))
    expect_same(sweep, points, version);
  else
    create(sweep, points, version);
}

void SweepResults::create(const SweepFile& sweep, const std::vector<PlannedPoint>& points,
                          const std::string& version) {
  Transaction transaction(database_);
  database_.execute(fmt::format(
      "CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT) WITHOUT ROWID;"
      "CREATE TABLE points (point INTEGER PRIMARY KEY, session TEXT NOT NULL);"
      "CREATE TABLE results (point INTEGER, repeat INTEGER, seed INTEGER, status TEXT NOT NULL,"
      " exit_code INTEGER, signal INTEGER, message TEXT{}{}, PRIMARY KEY (point, repeat)) WITHOUT ROWID;"
      "CREATE TABLE host (point INTEGER, repeat INTEGER, wall_s REAL, cpu_s REAL, peak_rss_bytes REAL,"
      " PRIMARY KEY (point, repeat)) WITHOUT ROWID",
      column_list(keys_, ""), column_list(sweep_figure_names(), " REAL")));
  Statement meta(database_, "INSERT INTO meta VALUES (?, ?)");
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"format", sweep_format},
                                   {"version", version},
                                   {"repeat", std::to_string(sweep.repeat)}}) {
    meta.bind(1, key);
    meta.bind(2, value);
    meta.step();
    meta.reset();
  }
  Statement insert_point(database_, "INSERT INTO points VALUES (?, ?)");
  Statement insert_run(database_,
                       fmt::format("INSERT INTO results (point, repeat, seed, status{}) VALUES ({})",
                                   column_list(keys_, ""), parameters(4 + keys_.size())));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto point = static_cast<std::int64_t>(i + 1);
    insert_point.bind(1, point);
    insert_point.bind(2, points[i].session_toml);
    insert_point.step();
    insert_point.reset();
    for (std::size_t k = 0; k < keys_.size(); ++k)
      bind_value(insert_run, static_cast<int>(5 + k), value_of(points[i].point, keys_[k]));
    for (std::int64_t repeat = 1; repeat <= sweep.repeat; ++repeat) {
      insert_run.bind(1, point);
      insert_run.bind(2, repeat);
      insert_run.bind(3, points[i].seed + repeat - 1);
      insert_run.bind(4, std::string(name_of(SweepOutcome::Status::pending)));
      insert_run.step();
      insert_run.reset();
    }
  }
  transaction.commit();
}

void SweepResults::expect_same(const SweepFile& sweep, const std::vector<PlannedPoint>& points,
                               const std::string& version) {
  const auto refuse = [&](const std::string& what) {
    throw input_error(
        "{}: holds the results of another sweep ({}); accepted: the sweep that it was begun with, or a new "
        "folder with --out",
        database_.file().string(), what);
  };
  if (!has_meta(database_) || meta_value(database_, "format") != sweep_format)
    refuse(fmt::format("its format is not {}", sweep_format));
  // Figures of two versions side by side would be compared as if they were of one.
  if (meta_value(database_, "version") != version)
    refuse(fmt::format("of version {}, this is {}", meta_value(database_, "version"), version));
  if (meta_value(database_, "repeat") != std::to_string(sweep.repeat)) refuse("'repeat' differs");
  Statement select(database_, "SELECT session FROM points ORDER BY point");
  for (const PlannedPoint& point : points) {
    if (!select.step()) refuse("it has fewer points");
    if (select.text(0) != point.session_toml) refuse("the session of " + point.point.place + " differs");
  }
  if (select.step()) refuse("it has more points");
  Statement columns(database_, "SELECT name FROM pragma_table_info('results')");
  std::vector<std::string> found;
  for (int column = 0; columns.step(); ++column) {
    if (column >= run_columns) found.push_back(columns.text(0));
  }
  std::vector<std::string> wanted = keys_;
  wanted.insert(wanted.end(), sweep_figure_names().begin(), sweep_figure_names().end());
  if (found != wanted) refuse("it has other columns");
}

std::vector<SweepRun> SweepResults::pending() {
  Statement select(database_,
                   "SELECT point, repeat, seed FROM results WHERE status = 'pending' ORDER BY point, repeat");
  std::vector<SweepRun> runs;
  while (select.step())
    runs.push_back({select.integer(0), select.integer(1), select.integer(2)});
  return runs;
}

void SweepResults::record(const SweepRun& run, const SweepOutcome& outcome) {
  std::string sets = "status = ?, exit_code = ?, signal = ?, message = ?";
  const bool done = outcome.status == SweepOutcome::Status::done;
  if (done) {
    for (const std::string& name : sweep_figure_names())
      sets += ", " + sql_name(name) + " = ?";
  }
  Transaction transaction(database_);
  Statement update(database_, "UPDATE results SET " + sets + " WHERE point = ? AND repeat = ?");
  int parameter = 0;
  update.bind(++parameter, std::string(name_of(outcome.status)));
  update.bind(++parameter, std::int64_t{outcome.exit_code});
  update.bind(++parameter, std::int64_t{outcome.signal});
  update.bind(++parameter, outcome.message);
  if (done) {
    BRACE_CHECK(outcome.figures.size() == sweep_figure_names().size());
    for (const std::optional<double>& figure : outcome.figures) {
      ++parameter;
      figure ? update.bind(parameter, *figure) : update.bind_null(parameter);
    }
  }
  update.bind(++parameter, run.point);
  update.bind(++parameter, run.repeat);
  update.step();
  if (done) {
    Statement host(database_, "INSERT OR REPLACE INTO host VALUES (?, ?, ?, ?, ?)");
    host.bind(1, run.point);
    host.bind(2, run.repeat);
    host.bind(3, outcome.host.wall_s);
    host.bind(4, outcome.host.cpu_s);
    host.bind(5, outcome.host.peak_rss_bytes);
    host.step();
  }
  transaction.commit();
}

void SweepResults::retry_failed() {
  database_.execute(
      "UPDATE results SET status = 'pending', exit_code = NULL, signal = NULL, message = NULL"
      " WHERE status IN ('failed', 'crashed')");
}

SweepCounts SweepResults::counts() {
  SweepCounts counts;
  Statement select(database_, "SELECT status, count(*) FROM results GROUP BY status");
  while (select.step()) {
    const std::string status = select.text(0);
    const std::int64_t count = select.integer(1);
    counts.runs += count;
    if (status == "pending") counts.pending = count;
    if (status == "done") counts.done = count;
    if (status == "failed") counts.failed = count;
    if (status == "crashed") counts.crashed = count;
  }
  return counts;
}

std::vector<SweepRow> SweepResults::rows() {
  std::string names = "point, repeat, seed, status, message";
  for (const std::string& name : sweep_figure_names())
    names += ", " + sql_name(name);
  Statement select(database_, "SELECT " + names + " FROM results ORDER BY point, repeat");
  std::vector<SweepRow> rows;
  while (select.step()) {
    SweepRow row{
        {select.integer(0), select.integer(1), select.integer(2)}, select.text(3), select.text(4), {}};
    for (std::size_t i = 0; i < sweep_figure_names().size(); ++i) {
      const std::string text = select.value_text(static_cast<int>(5 + i));
      row.figures.push_back(text.empty() ? std::nullopt : std::optional(std::strtod(text.c_str(), nullptr)));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void SweepResults::write_csv(const std::filesystem::path& file) {
  std::vector<std::string> names = {"point", "repeat", "seed", "status", "exit_code", "signal", "message"};
  names.insert(names.end(), keys_.begin(), keys_.end());
  names.insert(names.end(), sweep_figure_names().begin(), sweep_figure_names().end());
  const int columns = static_cast<int>(names.size());
  for (std::string& name : names)
    name = csv_cell(name);
  const std::filesystem::path partial = file.string() + ".partial";
  OutputFile output(partial);
  output.write(join(names, ",") + "\n");
  Statement select(database_, "SELECT * FROM results ORDER BY point, repeat");
  while (select.step()) {
    std::vector<std::string> cells;
    for (int column = 0; column < columns; ++column)
      cells.push_back(csv_cell(select.value_text(column)));
    output.write(join(cells, ",") + "\n");
  }
  output.close();
  std::filesystem::rename(partial, file);
}

}  // namespace brace
