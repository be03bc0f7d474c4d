#include "bench/raycast.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <thread>

#include "base/error.hpp"
#include "bench/raycast_rivals.hpp"
#include "bench/raycast_scene.hpp"
#include "runtime/host/stage_glsl.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/raycast/cast_pipeline.hpp"

namespace brace {

namespace {

double process_cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double host_load() {
  std::array<double, 1> load{};
  return getloadavg(load.data(), 1) == 1 ? load[0] : 0.0;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

double minimum(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::min_element(values.begin(), values.end());
}

/// The built-in stages with their defaults but for what the scene asks.
std::vector<PipelineStage> scene_stages(const std::filesystem::path& data_folder, const RaycastScene& scene) {
  std::vector<PipelineStage> stages;
  for (const char* id : {"rays/full_rate", "cast/dvr", "skip/none"}) {
    PipelineStage stage{read_stage_manifest(data_folder / "stages" / id / "stage.toml"), {}};
    for (const StageParameter& parameter : stage.stage.parameters) {
      double value = parameter.default_value;
      if (parameter.name == "step_voxels") value = scene.step_voxels;
      if (parameter.name == "termination_opacity") value = scene.termination_opacity;
      stage.values.push_back(value);
    }
    stages.push_back(std::move(stage));
  }
  return stages;
}

CastParts scene_parts(const std::filesystem::path& data_folder, const RaycastScene& scene) {
  const std::vector<PipelineStage> stages = scene_stages(data_folder, scene);
  std::vector<const PipelineStage*> pointers;
  for (const PipelineStage& stage : stages)
    pointers.push_back(&stage);
  const StageGlsl glsl = stage_glsl(pointers);
  CastParts parts;
  parts.glsl_folder = data_folder / "glsl";
  parts.kernels_folder = data_folder / "kernels";
  parts.stages = glsl.resolve;
  parts.constants = glsl.constants;
  parts.counters = true;
  return parts;
}

TransferTable scene_table(const TransferFunction& function) {
  const ValueRange range{0.0, 255.0};
  return bake(resolve(function, range), table_layout(VoxelType::uint8, range));
}

/// One of our cases, ready to run again.
struct Running {
  RaycastBenchCase result;
  std::vector<double> wall_ms, cpu_ms;
  TransferOnDevice transfer;
  EyeTarget target;
  gpu::CommandList commands;
};

/// The scene's volume on one data path and a case per transfer function.
class PathBench {
 public:
  PathBench(const gpu::Device& device, const RaycastBenchOptions& options, const RaycastScene& scene,
            VolumePath path, VoxelScan* scan)
      : device_(device) {
    const auto source = open_scene_volume();
    volume_ = VolumeOnDevice(device, *source, path, scan);
    pipeline_ = CastPipeline(device, compose_cast_kernels(scene_parts(options.data_folder, scene), volume_));
    rays_ = RayBuffers(device, options.size_px, options.size_px);
    cases_.resize(scene.transfers.size());
    for (std::size_t i = 0; i < cases_.size(); ++i)
      prepare(cases_[i], scene, scene.transfers[i]);
  }

  const VolumeOnDevice& volume() const { return volume_; }

  void run(int repetitions) {
    for (int i = 0; i < repetitions; ++i) {
      for (Running& one : cases_)
        measure(one);
    }
  }

  void finish(std::vector<RaycastBenchCase>& to) const {
    for (const Running& one : cases_) {
      RaycastBenchCase done = one.result;
      done.frame_ms_median = median(one.wall_ms);
      done.frame_ms_min = minimum(one.wall_ms);
      done.samples_per_s = static_cast<double>(done.samples) / (1e-3 * done.frame_ms_median);
      if (device_.limits().is_software) done.cpu_ms_min = minimum(one.cpu_ms);
      to.push_back(done);
    }
  }

 private:
  void prepare(Running& one, const RaycastScene& scene, const RaycastScene::Transfer& transfer) {
    one.result.renderer = fmt::format("cast/dvr, {}", to_string(volume_.path()));
    one.result.transfer = transfer.name;
    one.transfer = TransferOnDevice(device_, scene_table(transfer.function), scene.step_voxels);
    one.target = EyeTarget(device_, scene.eye.width_px, scene.eye.height_px);
    CastPipeline::set_eye(device_, one.target, scene.eye, scene.placement, volume_, one.transfer);
    one.commands = gpu::CommandList(device_, "bench raycast");
    pipeline_.record(one.commands, {volume_, one.transfer, rays_, one.target});
    pipeline_.reset_counters(device_);
    gpu::submit_and_wait(one.commands);  // warms up, and counts
    one.result.samples = pipeline_.counted(device_).samples;
  }

  static void measure(Running& one) {
    const double cpu_before_ms = process_cpu_ms();
    const auto begin = std::chrono::steady_clock::now();
    gpu::submit_and_wait(one.commands);
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin;
    one.wall_ms.push_back(wall.count());
    one.cpu_ms.push_back(process_cpu_ms() - cpu_before_ms);
  }

  const gpu::Device& device_;
  VolumeOnDevice volume_;
  CastPipeline pipeline_;
  RayBuffers rays_;
  std::vector<Running> cases_;
};

}  // namespace

RaycastBenchResult bench_raycast(const RaycastBenchOptions& options) {
  const gpu::Device device(options.device);
  const RaycastScene scene = make_raycast_scene(options.size_px, options.size_px);
  RaycastBenchResult result;
  result.device = device.info().name;
  result.host_cores = std::thread::hardware_concurrency();
  result.host_load = host_load();
  result.repetitions = options.repetitions;
  result.size_px = options.size_px;

  VoxelScan scan(VoxelType::uint8);
  PathBench chosen(device, options, scene, VolumePath::automatic, &scan);
  const VolumePath other_path =
      chosen.volume().path() == VolumePath::packed ? VolumePath::sampler : VolumePath::packed;
  PathBench other(device, options, scene, other_path, nullptr);
  const VoxelStatistics statistics = scan.result();
  result.zero_voxels_ratio =
      static_cast<double>(statistics.counts[0]) / static_cast<double>(statistics.voxels);
  result.path_reason = chosen.volume().path_reason();

  const int before = (options.repetitions + 1) / 2;
  chosen.run(before);
  other.run(before);
  std::vector<RaycastBenchCase> rivals;
  if (options.rivals) measure_raycast_rivals(options, scene, rivals, result.notes);
  chosen.run(options.repetitions - before);
  other.run(options.repetitions - before);
  chosen.finish(result.cases);
  other.finish(result.cases);
  result.cases.insert(result.cases.end(), rivals.begin(), rivals.end());
  return result;
}

}  // namespace brace
