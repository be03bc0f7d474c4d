#include "runtime/replay/replay.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>

#include <sys/resource.h>

#include "base/error.hpp"
#include "runtime/replay/prediction_table.hpp"
#include "runtime/replay/series.hpp"
#include "runtime/replay/series_work.hpp"
#include "runtime/report/summary.hpp"

namespace brace {

namespace {

constexpr std::uint64_t kIdealBytesMax = 512u << 20;

double cpu_s(const rusage& usage) {
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Each fact once, by its name.
void add_measured(const std::vector<Series>& all, std::vector<Fact>& facts) {
  for (const Series& series : all) {
    for (const Fact& fact : series.host_facts) {
      const bool is_known =
          std::any_of(facts.begin(), facts.end(), [&](const Fact& known) { return known.name == fact.name; });
      if (!is_known) facts.push_back(fact);
    }
  }
}

HostFigures host_figures(std::chrono::steady_clock::time_point begin, const gpu::Device* device) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  HostFigures host;
  host.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  host.cpu_s = cpu_s(usage);
  host.peak_rss_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  host.facts.push_back({"device", device == nullptr ? "none used" : device->info().name});
  if (device != nullptr) host.facts.push_back({"driver", device->info().driver});
  host.facts.push_back({"threads", std::to_string(std::thread::hardware_concurrency())});
  return host;
}

std::string trace_name(const Session& session, const HeadTrace& head_trace) {
  return session.trace.neck ? head_trace.description : head_trace.trace.name();
}

std::string end_of(const Series& series) {
  if (!series.failure.empty()) return series.failure;
  return series.loop.trace_ended ? "the trace" : "the number of vsyncs asked for";
}

std::vector<Fact> run_facts(const Session& session, const HeadTrace& head_trace, const Headset& headset,
                            const Series& first) {
  std::vector<Fact> facts = {
      {"trace repairs", sim::describe(head_trace.repairs)},
      {"eye pictures", fmt::format("{} x {} px", headset.eye.width_px, headset.eye.height_px)},
      {"panels", fmt::format("{} x {} px", headset.panel.width_px, headset.panel.height_px)},
      {"volume", std::filesystem::path(session.scene.volume).filename().string()},
      {"transfer function", std::filesystem::path(session.scene.transfer_function).stem().string()},
      {"assumed by the profile", headset.profile.assumed.empty()
                                     ? "nothing"
                                     : fmt::format("{} values", headset.profile.assumed.size())},
      {"duplicate predictions", std::to_string(first.loop.duplicate_predictions)},
      {"run ended by", end_of(first)}};
  facts.insert(facts.end(), first.facts.begin(), first.facts.end());
  return facts;
}

/// A predictor that fails here does not take the run's data with it.
void add_prediction_table(const Session& session, const HeadTrace& head_trace, const Headset& headset,
                          ReportInput& input) {
  if (!input.failure.empty()) return;
  try {
    input.tables.push_back(prediction_table(session, head_trace, headset));
  } catch (const Error& error) {
    if (error.exit_code() != ExitCode::device_or_plugin_failed) throw;
    input.failure = error.what();
  }
}

ReportTable fault_table(const std::vector<Series>& all) {
  ReportTable table{"Watchdog", "", {"Stage", "Fault", "Count", "First frame"}, {}};
  for (const Series& series : all) {
    for (const WatchdogReport& fault : series.faults) {
      const std::string stage = series.label.empty() ? fault.stage : series.label + ": " + fault.stage;
      table.rows.push_back(
          {stage, fault.clause, std::to_string(fault.count), std::to_string(fault.first_frame)});
    }
  }
  table.note = table.rows.empty()
                   ? "Every stage kept to the rules."
                   : "Counts are of rays, words of memory or jobs; the frame is that of the job.";
  return table;
}

/// What the second series and those after it know that the first does not.
void add_facts_of_others(const std::vector<Series>& all, std::vector<Fact>& facts) {
  const auto known = [&](const Fact& fact) {
    return std::any_of(facts.begin(), facts.end(), [&](const Fact& other) {
      return other.name == fact.name && other.value == fact.value;
    });
  };
  std::vector<Fact> more;
  for (std::size_t i = 1; i < all.size(); ++i)
    for (const Fact& fact : all[i].facts)
      if (!known(fact)) more.push_back({all[i].label + ": " + fact.name, fact.value});
  facts.insert(facts.end(), more.begin(), more.end());
}

ReportInput report_input(const std::vector<LabelledSession>& sessions, const std::vector<Series>& all,
                         const Headset& headset, const HeadTrace& head_trace, const ReplayOptions& options) {
  const Session& session = sessions.front().session;
  ReportInput input;
  input.version = options.version;
  input.device = headset.profile.name;
  input.refresh_hz = headset.profile.refresh.hz();
  input.resolution_scale = session.device.resolution_scale;
  input.trace = trace_name(session, head_trace);
  input.clock = {session.clock.wall ? "wall" : "virtual", session.clock.queue, session.clock.cost,
                 session.clock.cost_resolution};
  // Where the recording lies differs between machines and must not make equal runs differ; session.toml has
  // it.
  if (session.clock.cost.rfind("recorded:", 0) == 0) input.clock.cost = "recorded";
  input.deterministic = true;
  for (const Series& series : all) {
    input.deterministic = input.deterministic && series.deterministic;
    RunSeries run;
    run.label = series.label;
    run.pipeline = series.pipeline;
    run.left_out = series.left_out;
    run.records = series.records.frames();
    run.jobs = series.jobs;
    run.pictures = series.pictures;
    run.stereo_layer_mib = series.stereo_layer_mib;
    for (const WatchdogReport& fault : series.faults)
      run.faults.push_back({fault.stage, fault.clause, fault.count, fault.first_frame});
    if (!series.failure.empty()) input.failure = series.failure;
    input.series.push_back(std::move(run));
  }
  input.facts = run_facts(session, head_trace, headset, all.front());
  add_facts_of_others(all, input.facts);
  add_prediction_table(session, head_trace, headset, input);
  if (session.run.watchdog != WatchdogLevel::off) {
    input.watchdog = to_string(session.run.watchdog);
    input.tables.push_back(fault_table(all));
  }
  input.session_toml = session.resolved_toml;
  return input;
}

}  // namespace

ReplayOutcome replay(const std::vector<LabelledSession>& sessions, const ReplayOptions& options,
                     const std::filesystem::path& destination) {
  BRACE_CHECK(!sessions.empty());
  const auto begin = std::chrono::steady_clock::now();
  RunDirectory run(destination);
  std::optional<gpu::Device> device;
  std::optional<Headset> headset;
  std::optional<HeadTrace> head_trace;
  IdealCache ideals(sessions.size() > 1 ? kIdealBytesMax : 0);
  std::vector<Series> all;
  for (const LabelledSession& labelled : sessions) {
    if (!device && needs_device(labelled.session)) device.emplace(gpu::DeviceOptions{.select = options.gpu});
    Headset own_headset = make_headset(labelled.session, options.data_folder);
    HeadTrace own_trace = load_head_trace(labelled.session.trace, options.data_folder);
    all.push_back(
        replay_series(labelled, options, own_headset, own_trace, device ? &*device : nullptr, run, ideals));
    if (!headset) {
      headset.emplace(std::move(own_headset));
      head_trace.emplace(std::move(own_trace));
    }
    if (!all.back().failure.empty()) break;
  }
  ReportInput input = report_input(sessions, all, *headset, *head_trace, options);
  input.host = host_figures(begin, device ? &*device : nullptr);
  add_measured(all, input.host.facts);
  if (device && !device->validation_messages().empty()) {
    throw device_error("the validation layers found a fault: {}", device->validation_messages().front());
  }
  write_run(run, input, options.data_folder / "report");
  run.commit();
  return {summary_json(input), input.failure};
}

}  // namespace brace
