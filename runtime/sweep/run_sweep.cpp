#include "runtime/sweep/run_sweep.hpp"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "base/error.hpp"
#include "runtime/report/output_file.hpp"
#include "runtime/report/text_file.hpp"
#include "runtime/sweep/child_process.hpp"
#include "runtime/sweep/sweep_folder.hpp"
#include "runtime/sweep/sweep_page.hpp"

namespace brace {

namespace fs = std::filesystem;

namespace {

struct Running {
  SweepRun run;
  fs::path directory, errors;
  ChildProcess child;
};

/// What is the same for all runs of a sweep.
struct Sweep {
  const SweepFile& file;
  const std::vector<PlannedPoint>& points;
  const SweepOptions& options;
  SweepFolder& folder;
  SweepResults& results;
};

const PlannedPoint& point_of(const Sweep& sweep, const SweepRun& run) {
  return sweep.points[static_cast<std::size_t>(run.point - 1)];
}

Overrides overrides_of(const SweepPoint& point) {
  Overrides overrides;
  for (const SweepSetting& setting : point.settings)
    overrides.emplace_back(setting.key, setting.toml_text);
  return overrides;
}

/// The software device takes every core for itself: as many such processes would only be in each other's way.
std::map<std::string, std::string> environment_of(int jobs) {
  if (jobs == 1 || std::getenv("LP_NUM_THREADS") != nullptr) return {};
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return {{"LP_NUM_THREADS", std::to_string(std::max(1, cores / jobs))}};
}

Running start(const Sweep& sweep, const SweepRun& run, int jobs) {
  const std::string name = fmt::format("{:06}-{}", run.point, run.repeat);
  const fs::path directory = sweep.folder.work() / name, errors = sweep.folder.work() / (name + ".txt");
  std::vector<std::string> words = {sweep.options.program.string(), "run", sweep.file.session.string()};
  for (const auto& [key, value] : overrides_of(point_of(sweep, run).point))
    words.insert(words.end(), {"--set", fmt::format("{}={}", key, value)});
  words.insert(words.end(), {"--seed", std::to_string(run.seed), "--out", directory.string()});
  words.insert(words.end(), sweep.options.arguments.begin(), sweep.options.arguments.end());
  return {run, directory, errors, ChildProcess(words, environment_of(jobs), errors)};
}

/// The last line of what a failed run said, without the program's name.
std::string message_of(const fs::path& errors) {
  std::string text = read_text_file(errors);
  while (!text.empty() && text.back() == '\n')
    text.pop_back();
  text.erase(0, text.rfind('\n') + 1);
  if (text.rfind("brace: ", 0) == 0) text.erase(0, 7);
  return text;
}

void keep(const Sweep& sweep, const Running& running) {
  const fs::path kept = sweep.folder.runs() / running.directory.filename();
  std::error_code error;
  fs::create_directories(kept.parent_path(), error);
  fs::remove_all(kept, error);  // of a run that was killed before it was recorded
  fs::rename(running.directory, kept, error);
  if (error) throw_file_error(kept, "cannot be put in place", error.value());
}

SweepOutcome outcome_of(const Running& running, const ChildEnd& end) {
  SweepOutcome outcome;
  outcome.exit_code = end.exit_code;
  outcome.signal = end.signal;
  if (end.signal != 0) {
    outcome.status = SweepOutcome::Status::crashed;
    outcome.message = fmt::format("ended by signal {}", end.signal);
  } else if (end.exit_code == child_not_started) {
    throw device_error("a run of the sweep cannot be started");
  } else if (end.exit_code != 0) {
    outcome.status = SweepOutcome::Status::failed;
    outcome.message = message_of(running.errors);
  } else {
    outcome.status = SweepOutcome::Status::done;
    outcome.figures = read_sweep_figures(running.directory);
    outcome.host = read_sweep_host_figures(running.directory);
  }
  return outcome;
}

void finish(const Sweep& sweep, const Running& running, const ChildEnd& end) {
  const SweepOutcome outcome = outcome_of(running, end);
  if (sweep.options.keep_runs && outcome.status == SweepOutcome::Status::done) keep(sweep, running);
  sweep.results.record(running.run, outcome);
  std::error_code ignored;
  fs::remove_all(running.directory, ignored);
  fs::remove(running.errors, ignored);
  if (sweep.options.told) sweep.options.told(running.run, outcome, sweep.results.counts());
}

/// Runs all of `waiting`, `jobs` at a time. What runs when it is interrupted is ended and not recorded.
void run_all(const Sweep& sweep, std::deque<SweepRun> waiting, int jobs) {
  std::vector<Running> running;
  const auto interrupted = [&] { return sweep.options.interrupted && sweep.options.interrupted(); };
  while (!interrupted() && !(waiting.empty() && running.empty())) {
    while (!waiting.empty() && running.size() < static_cast<std::size_t>(jobs)) {
      running.push_back(start(sweep, waiting.front(), jobs));
      waiting.pop_front();
    }
    std::vector<const ChildProcess*> children;
    for (const Running& one : running)
      children.push_back(&one.child);
    wait_for_any(children);
    if (interrupted()) return;
    for (std::size_t i = 0; i < running.size();) {
      const std::optional<ChildEnd> end = running[i].child.ended();
      if (!end) {
        ++i;
        continue;
      }
      finish(sweep, running[i], *end);
      running.erase(running.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

}  // namespace

std::vector<PlannedPoint> plan_sweep(const SweepFile& sweep, const StageRegistry& stages) {
  std::vector<PlannedPoint> planned;
  for (const SweepPoint& point : sweep.points) {
    Session session;
    try {
      session = read_session(sweep.session, overrides_of(point), stages);
    } catch (const Error& e) {
      throw Error(e.exit_code(), point.place + ": " + e.what());
    }
    if (!session.compare.empty()) {
      throw input_error("{}: has a [compare] section; accepted in a sweep: a session without one",
                        sweep.session.string());
    }
    planned.push_back({point, session.resolved_toml, static_cast<std::int64_t>(session.run.seed),
                       session.clock.cost == "measured"});
    if (planned.back().seed > INT64_MAX - sweep.repeat)
      throw input_error("{}: run.seed is too large for {} repetitions", point.place, sweep.repeat);
  }
  return planned;
}

SweepCounts run_sweep(const SweepFile& sweep, const std::vector<PlannedPoint>& points,
                      const SweepOptions& options, const fs::path& folder) {
  SweepFolder place(folder);
  SweepResults results(place.results(), sweep, points, options.version);
  if (options.retry_failed) results.retry_failed();
  std::deque<SweepRun> together, alone;
  for (const SweepRun& run : results.pending())
    (points[static_cast<std::size_t>(run.point - 1)].alone ? alone : together).push_back(run);
  const Sweep all{sweep, points, options, place, results};
  run_all(all, std::move(together), options.jobs);
  run_all(all, std::move(alone), 1);
  results.write_csv(place.csv());
  if (!options.page_folder.empty()) {
    const fs::path partial = place.page().string() + ".partial";
    write_sweep_page(partial, sweep, results.rows(), options.version, options.page_folder);
    fs::rename(partial, place.page());
  }
  return results.counts();
}

}  // namespace brace
