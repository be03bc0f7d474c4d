#include <algorithm>
#include <optional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "runtime/conformance/conformance.hpp"
#include "runtime/gpu/device.hpp"
#include "runtime/host/plugin_library.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void print_clause(const std::string& stage, const ClauseResult& result) {
  fmt::print("[{}] {}: {}{}{}\n", result.passed ? " ok " : "FAIL", stage, result.clause,
             result.figure.empty() ? "" : ": ", result.figure);
  std::fflush(stdout);
}

bool runs_on_device(const StageInfo& stage) {
  return stage.family != "predict" && stage.family != "control" && stage.family != "cost";
}

/// The stages to check: those of a file or folder, or one that sessions can name.
std::vector<StageInfo> stages_of(const CheckStageCommand& command) {
  std::error_code ignored;
  if (fs::exists(command.file, ignored)) {
    StageRegistry registry;
    add_plugins(registry, {.given = {command.file}, .ambient = {}, .installed = {}});
    if (registry.stages().empty()) {
      throw input_error(
          "{}: there is no stage in it; accepted: a stage.toml, a shared library (.so), a folder "
          "with them, or FAMILY/NAME",
          command.file);
    }
    return registry.stages();
  }
  const std::size_t slash = command.file.find('/');
  const auto& families = stage_families();
  const std::string family = command.file.substr(0, slash);
  if (slash == std::string::npos || std::find(families.begin(), families.end(), family) == families.end()) {
    throw input_error(
        "check-stage: '{}' is not there; accepted: a stage.toml, a shared library (.so), a folder "
        "with them, or FAMILY/NAME of a stage that `brace list stages` shows",
        command.file);
  }
  const Stages known = make_stages(command.plugin_path);
  return {known.registry.find(family, command.file.substr(slash + 1), "check-stage")};
}

Json to_json(const std::vector<ClauseResult>& clauses) {
  Json out = Json::array();
  for (const ClauseResult& clause : clauses)
    out.push_back({{"clause", clause.clause}, {"passed", clause.passed}, {"figure", clause.figure}});
  return out;
}

struct Tally {
  std::size_t clauses = 0, failed = 0;
  Json stages = Json::array();
};

void count(Tally& tally, const std::string& stage, const std::string& origin,
           const std::vector<ClauseResult>& clauses) {
  const auto failed = static_cast<std::size_t>(
      std::count_if(clauses.begin(), clauses.end(), [](const ClauseResult& c) { return !c.passed; }));
  tally.clauses += clauses.size();
  tally.failed += failed;
  tally.stages.push_back(
      {{"stage", stage}, {"origin", origin}, {"passed", failed == 0}, {"clauses", to_json(clauses)}});
}

}  // namespace

int check_stage_command(const CheckStageCommand& command) {
  Tally tally;
  std::vector<StageInfo> stages;
  try {
    stages = stages_of(command);
  } catch (const Error& error) {
    std::error_code ignored;
    if (!fs::is_regular_file(command.file, ignored)) throw;
    // The file is there and is no plug-in: that is the first clause.
    const ClauseResult loads{"loads", false, error.what()};
    if (!command.json) print_clause(command.file, loads);
    count(tally, "", command.file, {loads});
  }
  std::optional<gpu::Device> device;
  for (const StageInfo& stage : stages) {
    if (!device && runs_on_device(stage))
      device.emplace(gpu::DeviceOptions{.select = command.gpu, .validation = true});
    CheckOptions options;
    options.device = device ? &*device : nullptr;
    options.data_folder = data_folder();
    if (!command.json)
      options.on_clause = [&](const ClauseResult& clause) { print_clause(stage.id(), clause); };
    count(tally, stage.id(), stage.origin.string(), check_stage(stage, options));
  }
  if (command.json) {
    fmt::print("{}\n", Json{{"passed", tally.failed == 0}, {"stages", tally.stages}}.dump(2));
  } else {
    fmt::print("{} clauses, {} kept, {} broken\n", tally.clauses, tally.clauses - tally.failed, tally.failed);
  }
  return static_cast<int>(tally.failed == 0 ? ExitCode::done : ExitCode::check_failed);
}

}  // namespace brace
