#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/plan/auto_cast.hpp"
#include "runtime/plan/plan.hpp"
#include "tools/command.hpp"
#include "tools/interrupt.hpp"

namespace brace {

namespace {

Overrides overrides_of(const RunCommand& command) {
  Overrides overrides = parse_settings(command.set);
  if (command.frames) overrides.emplace_back("run.frames", std::to_string(*command.frames));
  if (command.watchdog) overrides.emplace_back("run.watchdog", *command.watchdog);
  if (command.seed) overrides.emplace_back("run.seed", std::to_string(*command.seed));
  for (const auto& setting : plan_settings(command.keep, command.leave_out, command.plan))
    overrides.push_back(setting);
  return overrides;
}

/// A session as it is replayed: what plan.leave_out = "auto" leaves out is decided here, and told.
LabelledSession planned(const std::string& label, const SessionReader& read, const ReplayOptions& options) {
  Session session = read({});
  if (session.plan.mode != Session::Plan::Mode::automatic) return {label, std::move(session), {}};
  PlanTrials trials(options);
  const Plan plan = make_plan(read, trials);
  fmt::print(stderr, "plan{}: leaves out {}; {:.1f} % less per frame expected\n",
             label.empty() ? "" : " of " + label, plan.leave_out.empty() ? "nothing" : join(plan.leave_out),
             100.0 * plan.saving());
  return {label, read(settings_of(plan)), plan.reasons()};
}

/// The session itself, or one per case of its [compare] section.
std::vector<LabelledSession> sessions_of(const RunCommand& command, const StageRegistry& stages,
                                         const ReplayOptions& options) {
  const auto reader = [&](Overrides settings) {
    return [&, settings](const Overrides& more) {
      Overrides all = settings;
      all.insert(all.end(), more.begin(), more.end());
      return read_session(command.session, all, stages);
    };
  };
  const auto prepared = [&](const std::string& label, Overrides settings) {
    const CastDecision cast = decide_cast(reader(settings), stages, options);
    if (!cast.reason.empty() && options.messages) fmt::print(stderr, "cast/auto: {}\n", cast.reason);
    settings.insert(settings.end(), cast.settings.begin(), cast.settings.end());
    LabelledSession session = planned(label, reader(settings), options);
    session.session.cast_reason = cast.reason;
    return session;
  };
  const Overrides overrides = overrides_of(command);
  const Session session = read_session(command.session, overrides, stages);
  if (session.compare.empty()) return {prepared("", overrides)};
  std::vector<LabelledSession> sessions;
  for (const Session::Case& one : session.compare) {
    Overrides settings = overrides;
    settings.insert(settings.end(), one.settings.begin(), one.settings.end());
    sessions.push_back(prepared(one.label, settings));
  }
  return sessions;
}

void print_headlines(const nlohmann::ordered_json& summary, const std::filesystem::path& out) {
  const auto line = [](const char* name, const std::string& text) { fmt::print("  {:<22}{}\n", name, text); };
  const auto number = [](const nlohmann::ordered_json& value, const char* format) {
    return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : std::string("-");
  };
  const auto percentiles = [&](const nlohmann::ordered_json& d) {
    return fmt::format("p50 {}  p95 {}  p99 {}  max {} ms", number(d["p50"], "{:.2f}"),
                       number(d["p95"], "{:.2f}"), number(d["p99"], "{:.2f}"), number(d["max"], "{:.2f}"));
  };
  line("vsyncs", fmt::format("{}, missed {} ({} %), longest stale run {}", summary["vsyncs"].dump(),
                             summary["missed_vsyncs"].dump(),
                             fmt::format("{:.2f}", 100.0 * summary["missed_ratio"].get<double>()),
                             summary["longest_stale_run"].dump()));
  line("motion-to-photon", "rotation    " + percentiles(summary["mtp_ms"]["rotation"]));
  line("", "translation " + percentiles(summary["mtp_ms"]["translation"]));
  line("eye frames", fmt::format("{} fps, 1 % low {} fps", number(summary["fps_avg"], "{:.1f}"),
                                 number(summary["fps_1pct_low"], "{:.1f}")));
  if (summary["frames_shown"] == 0)
    line("", "none was done by the end of the run: nothing was shown, and no vsync counts as missed");
  const auto& dssim = summary["dssim"];
  line("DSSIM", fmt::format("mean {}  p95 {}  max {}", number(dssim["mean"], "{:.4f}"),
                            number(dssim["p95"], "{:.4f}"), number(dssim["max"], "{:.4f}")));
  for (const auto& fault : summary.value("watchdog", nlohmann::ordered_json::array())) {
    line("watchdog",
         fmt::format("{}: {}, {} times, first in frame {}", fault["stage"].get<std::string>(),
                     fault["fault"].get<std::string>(), fault["count"].dump(), fault["first_frame"].dump()));
  }
  line("report", (out / "report.html").string());
}

}  // namespace

Overrides parse_settings(const std::vector<std::string>& settings) {
  Overrides overrides;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      throw input_error("--set {}: accepted: KEY=VALUE, e.g. --set pipeline.warp=none", setting);
    }
    overrides.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
  }
  return overrides;
}

Overrides plan_settings(const std::vector<std::string>& keep, const std::vector<std::string>& leave_out,
                        bool automatic) {
  Overrides settings;
  if (automatic || !leave_out.empty()) {
    std::vector<std::string> words = {automatic ? "auto" : "idle"};
    words.insert(words.end(), leave_out.begin(), leave_out.end());
    settings.emplace_back("plan.leave_out", join(words, ","));
  }
  if (!keep.empty()) settings.emplace_back("plan.keep", join(keep, ","));
  return settings;
}

ReplayOptions replay_options(const StageRegistry& stages, const std::string& gpu) {
  return {.data_folder = data_folder(),
          .gpu = gpu,
          .version = BRACE_VERSION,
          .no_warp = {stages.find("warp", "none", "built in"), {}},
          .full_rate = {stages.find("rays", "full_rate", "built in"), {}},
          .interrupted = interrupted,
          .measurements = std::make_shared<gpu::Measurements>()};
}

int run_command(const RunCommand& command) {
  note_interrupts();
  const auto [stages, plugins] = make_stages(command.plugin_path);
  warn_of_broken(plugins);
  const ReplayOptions options = replay_options(stages, command.gpu);
  const std::vector<LabelledSession> sessions = sessions_of(command, stages, options);
  const std::filesystem::path out = command.out.empty()
                                        ? std::filesystem::path("runs") / sessions.front().session.name
                                        : std::filesystem::path(command.out);
  const ReplayOutcome outcome = replay(sessions, options, out);
  if (command.json) {
    fmt::print("{}\n", outcome.summary_json);
  } else {
    print_headlines(nlohmann::ordered_json::parse(outcome.summary_json), out);
  }
  if (!outcome.failure.empty()) {
    throw device_error("{}; the run is incomplete: {} holds it up to there", outcome.failure, out.string());
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace brace
