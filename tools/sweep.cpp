#include <filesystem>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "runtime/replay/replay.hpp"
#include "runtime/report/progress.hpp"
#include "runtime/sweep/run_sweep.hpp"
#include "tools/command.hpp"
#include "tools/interrupt.hpp"

namespace brace {

namespace {

namespace fs = std::filesystem;

/// What every run of the sweep is started with besides its session.
std::vector<std::string> arguments_of(const SweepCommand& command) {
  std::vector<std::string> arguments;
  if (!command.gpu.empty()) arguments.insert(arguments.end(), {"--gpu", command.gpu});
  for (const std::string& place : command.plugin_path)
    arguments.insert(arguments.end(), {"--plugin-path", place});
  return arguments;
}

void tell_trouble(const SweepFile& sweep, const SweepRun& run, const SweepOutcome& outcome) {
  if (outcome.status == SweepOutcome::Status::done) return;
  fmt::print(stderr, "{}, repetition {}: {}: {}\n",
             sweep.points[static_cast<std::size_t>(run.point - 1)].place, run.repeat, name_of(outcome.status),
             outcome.message);
}

void print_counts(const SweepCounts& counts, const fs::path& out, bool json) {
  if (json) {
    const nlohmann::ordered_json text = {{"out", out.string()},       {"runs", counts.runs},
                                         {"done", counts.done},       {"failed", counts.failed},
                                         {"crashed", counts.crashed}, {"pending", counts.pending}};
    fmt::print("{}\n", text.dump(2));
    return;
  }
  fmt::print("  {:<10}{} of {}, {} failed, {} crashed\n", "done", counts.done, counts.runs, counts.failed,
             counts.crashed);
  fmt::print("  {:<10}{}\n", "results", (out / "results.sqlite").string());
  fmt::print("  {:<10}{}\n", "", (out / "results.csv").string());
  fmt::print("  {:<10}{}\n", "page", (out / "report.html").string());
}

}  // namespace

int sweep_command(const SweepCommand& command) {
  note_interrupts();
  const auto [stages, plugins] = make_stages(command.plugin_path);
  warn_of_broken(plugins);
  const SweepFile sweep = read_sweep(command.file);
  const std::vector<PlannedPoint> points = plan_sweep(sweep, stages);
  const fs::path out =
      fs::absolute(command.out.empty() ? fs::path("sweeps") / command.file.stem() : fs::path(command.out));
  SweepOptions options;
  options.program = "/proc/self/exe";  // this very program, even if another one is installed meanwhile
  options.arguments = arguments_of(command);
  options.version = BRACE_VERSION;
  options.page_folder = data_folder() / "report";
  options.jobs = command.jobs;
  options.retry_failed = command.retry_failed;
  options.keep_runs = command.keep_runs;
  options.interrupted = interrupted;
  ProgressMeter progress("sweep", points.size() * static_cast<std::size_t>(sweep.repeat), "runs");
  options.told = [&](const SweepRun& run, const SweepOutcome& outcome, const SweepCounts& counts) {
    tell_trouble(sweep, run, outcome);
    progress.update(static_cast<std::uint64_t>(counts.runs - counts.pending));
  };
  const SweepCounts counts = run_sweep(sweep, points, options, out);
  if (interrupted()) {
    fmt::print(stderr, "brace: interrupted with {} of {} runs to go; the same command goes on from there\n",
               counts.pending, counts.runs);
    end_by_noted_signal();
  }
  progress.finish();
  print_counts(counts, out, command.json);
  return static_cast<int>(counts.done == counts.runs ? ExitCode::done : ExitCode::check_failed);
}

}  // namespace brace
