#include <algorithm>
#include <cstdlib>
#include <functional>

#include <fmt/core.h>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "bench/costs.hpp"
#include "bench/distort.hpp"
#include "bench/host.hpp"
#include "bench/integrators.hpp"
#include "bench/mab.hpp"
#include "bench/plan.hpp"
#include "bench/raycast.hpp"
#include "bench/replay.hpp"
#include "bench/scaling.hpp"
#include "bench/schedule.hpp"
#include "bench/skip.hpp"
#include "bench/stereo.hpp"
#include "bench/warp.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

gpu::DeviceOptions device_options(const BenchCommand& command) {
  return {.select = command.gpu};
}

std::string run_raycast(const BenchCommand& command) {
  RaycastBenchOptions options;
  options.device = device_options(command);
  options.data_folder = data_folder();
  options.stages = make_stages({}).registry;
  if (command.quick) options.repetitions = 3;
  const RaycastBenchResult result = bench_raycast(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_distort(const BenchCommand& command) {
  DistortBenchOptions options;
  options.device = device_options(command);
  options.data_folder = data_folder();
  if (command.quick) options.repetitions = 10;
  const DistortBenchResult result = bench_distort(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_host(const BenchCommand& command) {
  const gpu::Device device(device_options(command));
  HostBenchOptions options;
  options.device = &device;
  options.data_folder = data_folder();
  if (command.quick) options.frames = 20'000;
  const HostBenchResult result = bench_host(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_replay(const BenchCommand& command) {
  ReplayBenchOptions options;
  options.simulated_hours = command.quick ? 0.5 : 24;
  options.model = find_cost_model(data_folder() / "costs", "gtx-1080");
  const ReplayBenchResult result = bench_replay(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_skip(const BenchCommand& command) {
  SkipBenchOptions options;
  options.device = device_options(command);
  options.data_folder = data_folder();
  options.progress = [](std::string_view line) { fmt::print(stderr, "{}\n", line); };
  if (command.quick) {
    options.divisor = 4;
    options.repetitions = 3;
    options.views = 2;
  }
  if (!command.scenes.empty()) options.scenes = command.scenes;
  if (!command.parts.empty()) options.parts = command.parts;
  if (!command.partitions.empty()) options.partitions = command.partitions;
  options.volumes = command.volumes;
  options.viewport_px = command.viewport_px;
  const SkipBenchResult result = bench_skip(options);
  if (!command.out.empty()) write_skip_bench(result, command.out);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_costs(const BenchCommand& command) {
  CostBenchOptions options{device_options(command), data_folder(), make_stages({}).registry};
  if (command.quick) options.repetitions = 2;
  const CostBenchResult result = bench_costs(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_integrators(const BenchCommand& command) {
  IntegratorBenchOptions options;
  options.device = device_options(command);
  options.data_folder = data_folder();
  options.quick = command.quick;
  if (const char* folder = std::getenv("BRACE_BENCH_VOLUMES"); folder != nullptr) options.volumes = folder;
  const IntegratorBenchResult result = bench_integrators(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_mab(const BenchCommand& command) {
  MabBenchOptions options;
  options.device = device_options(command);
  options.data_folder = data_folder();
  options.stages = make_stages({}).registry;
  options.progress = [](std::string_view line) { fmt::print(stderr, "{}\n", line); };
  if (command.quick) {
    options.volumes.resize(1);
    options.resolution_scale = 0.15;
    options.repetitions = 3;
  }
  if (!command.volumes.empty()) options.volumes = command.volumes;
  if (!command.parts.empty()) options.parts = command.parts;
  const MabBenchResult result = bench_mab(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_scaling(const BenchCommand& command) {
  ScalingBenchOptions options;
  options.device = device_options(command);
  options.data_folder = data_folder();
  options.stages = make_stages({}).registry;
  options.progress = [](std::string_view line) { fmt::print(stderr, "{}\n", line); };
  if (command.quick) {
    options.repetitions = 2;
    options.thread_pictures = {{256, 256}};
    options.image_edges_px = {64, 128, 256};
    options.volumes = {{64, 64, 64}, {128, 128, 128}, {192, 192, 150}};
    options.empty_shares = {0.0, 0.5, 0.9, 0.99};
    options.size_px = 256;
    options.edge_voxels = 128;
  }
  if (!command.parts.empty()) options.parts = command.parts;
  const ScalingBenchResult result = bench_scaling(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_schedule(const BenchCommand& command) {
  const ScheduleBenchResult result = bench_schedule({make_stages({}).registry});
  return command.json ? to_json(result) : to_text(result);
}

std::string run_stereo(const BenchCommand& command) {
  StereoBenchOptions options;
  options.device = device_options(command);
  options.data_folder = data_folder();
  options.stages = make_stages({}).registry;
  options.model = find_cost_model(data_folder() / "costs", "gtx-1080");
  options.software_model = find_cost_model(data_folder() / "costs", "lavapipe-2core");
  options.progress = [](std::string_view line) { fmt::print(stderr, "{}\n", line); };
  if (command.quick) {
    options.views = 8;
    options.resolution_scale = 0.1;
    options.ladder_scale = 0.06;
    options.scales = {0.05, 0.1};
  }
  if (!command.volumes.empty()) options.volumes = command.volumes;
  if (!command.parts.empty()) options.parts = command.parts;
  const StereoBenchResult result = bench_stereo(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_warp(const BenchCommand& command) {
  WarpBenchOptions options;
  options.device = device_options(command);
  options.data_folder = data_folder();
  options.stages = make_stages({}).registry;
  if (command.quick) options.resolution_scale = 0.2;
  const WarpBenchResult result = bench_warp(options);
  return command.json ? to_json(result) : to_text(result);
}

std::string run_plan(const BenchCommand& command) {
  PlanBenchOptions options;
  options.device = device_options(command);
  options.data_folder = data_folder();
  options.stages = make_stages({}).registry;
  if (command.quick) {
    options.resolution_scale = 0.15;
    options.repetitions = 10;
  }
  if (!command.volumes.empty()) options.volumes = command.volumes;
  const PlanBenchResult result = bench_plan(options);
  return command.json ? to_json(result) : to_text(result);
}

struct Benchmark {
  std::string name;
  std::function<std::string(const BenchCommand&)> run;
};

const std::vector<Benchmark>& benchmarks() {
  static const std::vector<Benchmark> all = {{"raycast", run_raycast},
                                             {"replay", run_replay},
                                             {"distort", run_distort},
                                             {"skip", run_skip},
                                             {"costs", run_costs},
                                             {"host", run_host},
                                             {"integrators", run_integrators},
                                             {"mab", run_mab},
                                             {"plan", run_plan},
                                             {"scaling", run_scaling},
                                             {"schedule", run_schedule},
                                             {"stereo", run_stereo},
                                             {"warp", run_warp}};
  return all;
}

}  // namespace

int bench_command(const BenchCommand& command) {
  std::vector<std::string> names;
  for (const Benchmark& benchmark : benchmarks()) {
    names.push_back(benchmark.name);
    if (benchmark.name != command.name) continue;
    fmt::print("{}\n", benchmark.run(command));
    return static_cast<int>(ExitCode::done);
  }
  throw input_error("bench: there is no benchmark '{}'{}; accepted: {}", command.name,
                    did_you_mean(command.name, names), join(names));
}

}  // namespace brace
