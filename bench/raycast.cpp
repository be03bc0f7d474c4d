#include "bench/raycast.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <thread>

#include "base/error.hpp"
#include "bench/median.hpp"
#include "bench/raycast_rivals.hpp"
#include "bench/raycast_scene.hpp"
#include "runtime/host/stage_glsl.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/raycast/native_steps.hpp"
#include "runtime/raycast/path_choice.hpp"
#include "runtime/skip/skip_structure.hpp"

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

double minimum(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::min_element(values.begin(), values.end());
}

/// A stage with its defaults but for what the scene asks.
PipelineStage with_scene_values(StageInfo info, const RaycastScene& scene) {
  PipelineStage stage{std::move(info), {}};
  for (const StageParameter& parameter : stage.stage.parameters) {
    double value = parameter.default_value;
    if (parameter.name == "step_voxels") value = scene.step_voxels;
    if (parameter.name == "termination_opacity") value = scene.termination_opacity;
    stage.values.push_back(value);
  }
  return stage;
}

CastParts scene_parts(const std::filesystem::path& data_folder, const RaycastScene& scene, SkipKind skip) {
  std::vector<PipelineStage> stages;
  for (const std::string& id :
       {std::string("rays/full_rate"), std::string("cast/dvr"), std::string("skip/") + to_string(skip)})
    stages.push_back(
        with_scene_values(read_stage_manifest(data_folder / "stages" / id / "stage.toml"), scene));
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

/// The scene's volume on one data path.
struct SceneVolume {
  SceneVolume(const gpu::Device& device, const VolumePathChoice& path) : scan(VoxelType::uint8) {
    const auto source = open_scene_volume();
    volume = VolumeOnDevice(device, *source, path, &scan);
    statistics = scan.result();
  }
  VoxelScan scan;
  VolumeOnDevice volume;
  VoxelStatistics statistics;
};

/// Who casts: cast/dvr where `native` is null.
struct Renderer {
  const SceneVolume& scene_volume;
  SkipKind skip = SkipKind::none;
  const StageInfo* native = nullptr;
};

/// One renderer with a case per transfer function.
class RendererBench {
 public:
  RendererBench(const gpu::Device& device, const RaycastBenchOptions& options, const RaycastScene& scene,
                const Renderer& renderer)
      : device_(device),
        scene_(scene),
        volume_(renderer.scene_volume.volume),
        rays_(device, options.size_px, options.size_px),
        commands_(device, "bench raycast"),
        skip_kernels_(device, options.data_folder / "kernels" / "skip") {
    CastParts parts = scene_parts(options.data_folder, scene, renderer.skip);
    parts.native_cast = renderer.native != nullptr;
    pipeline_ = CastPipeline(device, compose_cast_kernels(parts, volume_));
    for (const RaycastScene::Transfer& transfer : scene.transfers)
      cases_.push_back(prepare(renderer, transfer));
    if (renderer.native != nullptr) activate(with_scene_values(*renderer.native, scene));
    for (Running& one : cases_)
      count(one);
  }

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
  /// One case, ready to run again.
  struct Running {
    RaycastBenchCase result;
    std::vector<double> wall_ms, cpu_ms;
    TransferTable table;
    TransferOnDevice transfer;
    EyeTarget target;
    std::unique_ptr<SkipStructure> skip;
  };

  Running prepare(const Renderer& renderer, const RaycastScene::Transfer& transfer) {
    Running one;
    one.result.renderer = renderer.native != nullptr ? renderer.native->id()
                                                     : fmt::format("cast/dvr, {}", to_string(volume_.path()));
    if (renderer.skip != SkipKind::none)
      one.result.renderer += fmt::format(", skip/{}", to_string(renderer.skip));
    one.result.transfer = transfer.name;
    one.result.skips = renderer.skip != SkipKind::none;
    one.table = scene_table(transfer.function);
    one.transfer = TransferOnDevice(device_, one.table, scene_.step_voxels);
    one.target = EyeTarget(device_, scene_.eye.width_px, scene_.eye.height_px);
    CastPipeline::set_eye(device_, one.target, scene_.eye, scene_.placement, volume_, one.transfer);
    if (renderer.skip == SkipKind::none) return one;
    SkipOptions options;
    options.kind = renderer.skip;
    const SkipScene seen{volume_, renderer.scene_volume.statistics, std::span(&one.table, 1)};
    one.skip = make_skip_structure(skip_kernels_, seen, options);
    commands_.reset();
    one.skip->update(commands_, one.table);
    gpu::submit_and_wait(commands_);
    return one;
  }

  void activate(const PipelineStage& stage) {
    ActivationInput input = activation_input(device_, volume_, scene_.placement, cases_.front().table,
                                             scene_.step_voxels, scene_.eye.width_px, scene_.eye.height_px);
    input.open_volume = [] { return open_scene_volume(); };
    activation_ = std::make_unique<StageActivation>(input);
    native_ = NativeStage(stage);
    native_.activate(activation_->get());
  }

  EyeCastOutcome cast(const Running& one) {
    CastPipeline::Resources resources{volume_, one.transfer, rays_, one.target};
    if (one.skip) {
      resources.more = one.skip->bindings();
      resources.skip_map = one.skip->map_buffers();
    }
    const EyeCast eye{.device = device_,
                      .pipeline = pipeline_,
                      .resources = resources,
                      .view = scene_.eye,
                      .cast = native_ ? &native_ : nullptr};
    return cast_eye(eye, commands_, host_rays_);
  }

  /// Warms up, and counts.
  void count(Running& one) {
    pipeline_.reset_counters(device_);
    const EyeCastOutcome done = cast(one);
    one.result.samples = native_ ? done.counted.samples : pipeline_.counted(device_).samples;
  }

  void measure(Running& one) {
    const double cpu_before_ms = process_cpu_ms();
    const auto begin = std::chrono::steady_clock::now();
    cast(one);
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin;
    one.wall_ms.push_back(wall.count());
    one.cpu_ms.push_back(process_cpu_ms() - cpu_before_ms);
  }

  const gpu::Device& device_;
  const RaycastScene& scene_;
  const VolumeOnDevice& volume_;
  CastPipeline pipeline_;
  RayBuffers rays_;
  gpu::CommandList commands_;
  SkipKernels skip_kernels_;
  std::vector<Running> cases_;
  std::unique_ptr<StageActivation> activation_;
  NativeStage native_;
  HostRays host_rays_;
};

const StageInfo* find_native(const StageRegistry& registry) {
  for (const StageInfo& stage : registry.stages()) {
    if (stage.id() == "cast/native") return &stage;
  }
  return nullptr;
}

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

  gpu::Measurements measurements;
  const VolumeInfo info = open_scene_volume()->info();
  const SceneVolume chosen(
      device, choose_volume_path(device, info, VolumePath::automatic, options.data_folder, measurements));
  const bool is_packed = chosen.volume.path() == VolumePath::packed;
  const SceneVolume other(device, choose_volume_path(info, device.limits(),
                                                     is_packed ? VolumePath::sampler : VolumePath::packed));
  result.zero_voxels_ratio =
      static_cast<double>(chosen.statistics.counts[0]) / static_cast<double>(chosen.statistics.voxels);
  result.path_reason = chosen.volume.path_reason();
  if (const std::string& figures = chosen.volume.path_figures(); !figures.empty())
    result.path_reason += "; " + figures;

  std::vector<Renderer> renderers = {{chosen}, {other}, {chosen, SkipKind::distance_map}};
  if (const StageInfo* native = find_native(options.stages)) {
    renderers.push_back({chosen, SkipKind::none, native});
    renderers.push_back({chosen, SkipKind::distance_map, native});
  } else {
    result.notes.emplace_back("cast/native was not measured: its plug-in was not found");
  }
  std::vector<std::unique_ptr<RendererBench>> ours;
  for (const Renderer& renderer : renderers)
    ours.push_back(std::make_unique<RendererBench>(device, options, scene, renderer));

  const int before = (options.repetitions + 1) / 2;
  for (const auto& bench : ours)
    bench->run(before);
  std::vector<RaycastBenchCase> rivals;
  if (options.rivals) measure_raycast_rivals(options, scene, rivals, result.notes);
  for (const auto& bench : ours)
    bench->run(options.repetitions - before);
  for (const auto& bench : ours)
    bench->finish(result.cases);
  result.cases.insert(result.cases.end(), rivals.begin(), rivals.end());
  return result;
}

}  // namespace brace
