#include <fmt/core.h>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "bench/replay.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

int run_replay(const BenchCommand& command) {
  ReplayBenchOptions options;
  options.simulated_hours = command.quick ? 0.5 : 24;
  options.model = find_cost_model(data_folder() / "costs", "gtx-1080");
  const ReplayBenchResult result = bench_replay(options);
  fmt::print("{}\n", command.json ? to_json(result) : to_text(result));
  return 0;
}

}  // namespace

int bench_command(const BenchCommand& command) {
  static const std::vector<std::string> names = {"replay"};
  if (command.name == "replay") return run_replay(command);
  throw input_error("bench: there is no benchmark '{}'{}; accepted: {}", command.name,
                    did_you_mean(command.name, names), join(names));
}

}  // namespace brace
