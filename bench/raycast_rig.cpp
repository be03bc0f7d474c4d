#include "bench/raycast_rig.hpp"

#include <array>
#include <cstdlib>
#include <ctime>
#include <numeric>

#include "runtime/host/stage_glsl.hpp"

namespace brace {

namespace {

/// A stage with its defaults but for what the scene asks.
PipelineStage with_scene_values(StageInfo info, const RaycastScene& scene, int threads) {
  PipelineStage stage{std::move(info), {}};
  for (const StageParameter& parameter : stage.stage.parameters) {
    double value = parameter.default_value;
    if (parameter.name == "step_voxels") value = scene.step_voxels;
    if (parameter.name == "termination_opacity") value = scene.termination_opacity;
    if (parameter.name == "threads") value = threads;
    stage.values.push_back(value);
  }
  return stage;
}

CastParts scene_parts(const std::filesystem::path& data_folder, const RaycastScene& scene, SkipKind skip) {
  std::vector<PipelineStage> stages;
  for (const std::string& id :
       {std::string("rays/full_rate"), std::string("cast/dvr"), std::string("skip/") + to_string(skip)})
    stages.push_back(
        with_scene_values(read_stage_manifest(data_folder / "stages" / id / "stage.toml"), scene, 0));
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

}  // namespace

double host_load() {
  std::array<double, 1> load{};
  return getloadavg(load.data(), 1) == 1 ? load[0] : 0.0;
}

double process_cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

const StageInfo* find_native(const StageRegistry& registry) {
  for (const StageInfo& stage : registry.stages()) {
    if (stage.id() == "cast/native") return &stage;
  }
  return nullptr;
}

SceneVolume::SceneVolume(const gpu::Device& device, const SceneBall& of, const VolumePathChoice& path)
    : ball(of), scan(VoxelType::uint8) {
  const auto source = open_scene_volume(ball);
  volume = VolumeOnDevice(device, *source, path, &scan);
  statistics = scan.result();
}

double SceneVolume::share_up_to(int value) const {
  const auto end = statistics.counts.begin() + value + 1;
  return static_cast<double>(std::accumulate(statistics.counts.begin(), end, std::uint64_t{0})) /
         static_cast<double>(statistics.voxels);
}

RaycastRig::RaycastRig(const gpu::Device& device, const std::filesystem::path& data_folder,
                       const RaycastScene& scene, const RigRenderer& renderer)
    : device_(device),
      scene_(scene),
      volume_(renderer.scene_volume.volume),
      rays_(device, scene.eye.width_px, scene.eye.height_px),
      commands_(device, "bench raycast"),
      skip_kernels_(device, data_folder / "kernels" / "skip") {
  CastParts parts = scene_parts(data_folder, scene, renderer.skip);
  parts.native_cast = renderer.native != nullptr;
  pipeline_ = CastPipeline(device, compose_cast_kernels(parts, volume_));
  for (const RaycastScene::Transfer& transfer : scene.transfers)
    cases_.push_back(prepare(renderer, transfer.function));
  if (renderer.native != nullptr) activate(renderer);
}

RaycastRig::Case RaycastRig::prepare(const RigRenderer& renderer, const TransferFunction& function) {
  Case one;
  one.table = scene_table(function);
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

void RaycastRig::activate(const RigRenderer& renderer) {
  ActivationInput input = activation_input(device_, volume_, scene_.placement, cases_.front().table,
                                           scene_.step_voxels, scene_.eye.width_px, scene_.eye.height_px);
  input.open_volume = [ball = renderer.scene_volume.ball] { return open_scene_volume(ball); };
  activation_ = std::make_unique<StageActivation>(input);
  native_ = NativeStage(with_scene_values(*renderer.native, scene_, renderer.threads));
  native_.activate(activation_->get());
}

CastPipeline::Resources RaycastRig::resources(const Case& one) const {
  CastPipeline::Resources resources{volume_, one.transfer, rays_, one.target};
  if (one.skip) {
    resources.more = one.skip->bindings();
    resources.skip_map = one.skip->map_buffers();
  }
  return resources;
}

EyeCast RaycastRig::eye(const CastPipeline::Resources& resources) const {
  return {.device = device_,
          .pipeline = pipeline_,
          .resources = resources,
          .view = scene_.eye,
          .full_rate = true,
          .cast = native_ ? &native_ : nullptr};
}

EyeCastOutcome RaycastRig::cast_frame(std::size_t transfer) {
  const CastPipeline::Resources in = resources(cases_[transfer]);
  return cast_eye(eye(in), commands_, host_rays_);
}

WorkCounts RaycastRig::count(std::size_t transfer) {
  pipeline_.reset_counters(device_);
  const EyeCastOutcome done = cast_frame(transfer);
  return native_ ? done.counted : pipeline_.counted(device_);
}

RaycastRig::CastTime RaycastRig::time_cast(std::size_t transfer) {
  const CastPipeline::Resources in = resources(cases_[transfer]);
  const CastArea all{0, 0, in.rays_across(), in.rays_down()};
  commands_.reset();
  pipeline_.record_opening(commands_, in, all);
  gpu::submit_and_wait(commands_);
  CastTime time;
  const double cpu_before_ms = process_cpu_ms();
  if (native_) {
    time.ms = cast_part(transfer, all).ms;
  } else {
    commands_.reset();
    commands_.barrier();
    commands_.begin_timing("cast");
    pipeline_.record_cast(commands_, in, all);
    commands_.barrier();
    commands_.end_timing();
    time.ms = 1e-6 * static_cast<double>(gpu::device_ns(gpu::submit_and_wait(commands_), "cast"));
  }
  if (native_ || device_.limits().is_software) time.cpu_ms = process_cpu_ms() - cpu_before_ms;
  return time;
}

RaycastRig::Part RaycastRig::cast_part(std::size_t transfer, const CastArea& area) {
  const CastPipeline::Resources in = resources(cases_[transfer]);
  Part part;
  part.ms = 1e-6 * static_cast<double>(to_ns(execute_cast(eye(in), area, host_rays_, part.counted)));
  return part;
}

}  // namespace brace
