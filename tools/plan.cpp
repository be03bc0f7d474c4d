#include <fmt/core.h>

#include "base/error.hpp"
#include "runtime/plan/auto_cast.hpp"
#include "runtime/plan/plan_check.hpp"
#include "runtime/plan/plan_text.hpp"
#include "tools/command.hpp"
#include "tools/interrupt.hpp"

namespace brace {

int plan_command(const PlanCommand& command) {
  note_interrupts();
  const auto [stages, plugins] = make_stages(command.plugin_path);
  warn_of_broken(plugins);
  Overrides overrides = parse_settings(command.set);
  if (command.frames) overrides.emplace_back("run.frames", std::to_string(*command.frames));
  for (const auto& setting : plan_settings(command.keep, command.leave_out, false))
    overrides.push_back(setting);
  const SessionReader read = [&, &registry = stages](const Overrides& more) {
    Overrides all = overrides;
    all.insert(all.end(), more.begin(), more.end());
    return read_session(command.session, all, registry);
  };
  const Session session = read({});
  if (!session.compare.empty())
    throw input_error("{}: has a [compare] section; a plan is made for one pipeline: choose with --set",
                      command.session.string());
  const ReplayOptions options = replay_options(stages, command.gpu);
  for (const auto& setting : decide_cast(read, stages, options).settings)
    overrides.push_back(setting);
  PlanTrials trials(options);
  const Plan plan = make_plan(read, trials);
  if (!command.check) {
    fmt::print("{}", command.json ? to_json(plan) + "\n" : to_text(plan));
    return static_cast<int>(ExitCode::done);
  }
  const std::filesystem::path out = command.out.empty()
                                        ? std::filesystem::path("runs") / (session.name + "-plan")
                                        : std::filesystem::path(command.out);
  const PlanCheck check = check_plan(plan, read, options, out);
  fmt::print("{}", command.json ? to_json(plan, &check) + "\n" : to_text(plan, check));
  return static_cast<int>(check.passed() ? ExitCode::done : ExitCode::check_failed);
}

}  // namespace brace
