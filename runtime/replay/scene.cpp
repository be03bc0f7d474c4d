#include "runtime/replay/scene.hpp"

#include <algorithm>

#include "runtime/gpu/shader_compiler.hpp"
#include "runtime/raycast/path_choice.hpp"
#include "runtime/raycast/volume_levels.hpp"
#include "runtime/replay/cast_integrator.hpp"
#include "runtime/replay/native_skip.hpp"
#include "runtime/replay/skip_choice.hpp"
#include "runtime/report/progress.hpp"

namespace brace {

namespace {

OpenOptions open_options(const Session::Scene& wanted) {
  OpenOptions open;
  open.non_finite = wanted.nan == "empty" ? NonFinitePolicy::treat_as_empty : NonFinitePolicy::reject;
  return open;
}

void build_skip_structure(const gpu::Device& device, const Session& session, const ReplayOptions& replay,
                          const Headset& headset, const VolumePlacement& placement, SceneOnDevice& scene) {
  const std::filesystem::path& data_folder = replay.data_folder;
  scene.skip_kernels = std::make_unique<SkipKernels>(device, data_folder / "kernels" / "skip");
  choose_skip_stage(session, scene, replay.messages);
  if (scene.skip_stage.stage.native != nullptr) {
    auto stage = std::make_unique<ActiveStage>(scene.skip_stage,
                                               scene_activation(device, session, headset, scene, placement));
    const SkipScene seen{scene.volume, scene.statistics};
    auto skip = std::make_unique<NativeSkip>(*scene.skip_kernels, seen, std::move(stage));
    scene.skip_memory = fmt::format("{} bytes: a map of distances", skip->device_bytes());
    scene.skip = std::move(skip);
    return;
  }
  // Structures belong to the stages that come with Brace; one of another origin works with what is bound
  // anyway.
  const std::string ours = (data_folder / "stages").string();
  if (scene.skip_stage.stage.origin.string().rfind(ours, 0) != 0) return;
  const SkipOptions options = skip_options(scene.skip_stage, gpu::default_cache_folder() / "skip");
  if (options.kind == SkipKind::none) return;
  scene.skip_memory = skip_memory(scene.volume.info(), options).formula;
  ProgressMeter meter("building " + scene.skip_stage.stage.id(), 1000, "‰");
  const std::vector<TransferTable> tables = scene.versions.typical_tables();
  scene.skip = make_skip_structure(
      *scene.skip_kernels, {scene.volume, scene.statistics, tables}, options,
      [&](double fraction) { meter.update(static_cast<std::uint64_t>(fraction * 1000.0)); });
  meter.finish();
}

}  // namespace

JobOutcome SceneOnDevice::show_transfer(const gpu::Device& device, std::int64_t version) {
  transfer_version = version;
  table = versions.table(version);
  transfer.update(device, table, step_units);
  JobOutcome outcome;
  outcome.work.bytes = table.entries.size() * sizeof(std::array<float, 4>);
  if (skip == nullptr) return outcome;
  if (!update_commands) update_commands = gpu::CommandList(device, "skip update");
  gpu::CommandList& commands = *update_commands;
  commands.reset();
  commands.begin_timing("update");
  outcome.work.bytes += skip->update(commands, table).bytes;
  commands.end_timing();
  outcome.device_time = SimDuration(gpu::device_ns(gpu::submit_and_wait(commands), "update"));
  return outcome;
}

double step_voxels_of(const Session& session) {
  const PipelineStage& cast = session.pipeline.at("cast");
  for (const StageParameter& parameter : cast.stage.parameters) {
    if (parameter.name == "step_voxels") return cast.value("step_voxels");
  }
  return 0.5;
}

bool same_volume(const Session& a, const Session& b) {
  return a.scene.volume == b.scene.volume && a.scene.nan == b.scene.nan &&
         a.scene.data_path == b.scene.data_path;
}

namespace {

/// A scene with the volume and its statistics alone.
std::unique_ptr<SceneOnDevice> load_volume(const gpu::Device& device, const Session& session,
                                           const ReplayOptions& options) {
  const Session::Scene& wanted = session.scene;
  const std::unique_ptr<VolumeSource> source = open_volume(wanted.volume, open_options(wanted));

  gpu::Measurements here;
  VolumePathChoice path =
      choose_volume_path(device, source->info(), parse_volume_path(wanted.data_path), options.data_folder,
                         options.measurements ? *options.measurements : here);
  ProgressMeter meter("loading", 1000, "‰");
  VoxelScan scan(source->info().type);
  auto scene = std::make_unique<SceneOnDevice>(
      std::make_shared<const VolumeOnDevice>(device, *source, std::move(path), &scan, [&](double fraction) {
        meter.update(static_cast<std::uint64_t>(fraction * 1000.0));
        throw_if_interrupted(options);
      }));
  meter.finish();
  scene->statistics = scan.result();
  return scene;
}

std::unique_ptr<SceneOnDevice> share_volume(const SceneOnDevice& other) {
  auto scene = std::make_unique<SceneOnDevice>(other.held_volume);
  scene->statistics = other.statistics;
  return scene;
}

}  // namespace

std::unique_ptr<SceneOnDevice> load_scene(const gpu::Device& device, const Session& session,
                                          const ReplayOptions& options, const Headset& headset,
                                          const VolumePlacement& placement, const SceneOnDevice* volume_of) {
  const Session::Scene& wanted = session.scene;
  std::unique_ptr<SceneOnDevice> scene =
      volume_of != nullptr ? share_volume(*volume_of) : load_volume(device, session, options);
  if (wants_levels(session.pipeline.at("cast"))) {
    scene->levels = volume_of != nullptr ? volume_of->levels : nullptr;
    if (!scene->levels)
      scene->levels =
          std::make_shared<VolumeLevels>(device, *open_volume(wanted.volume, open_options(wanted)));
  }

  const VolumeInfo& info = scene->volume.info();
  const ValueRange range = scene->statistics.range;
  const auto edges = box_size(info);
  const double voxel_length_m =
      wanted.size_m * voxel_length(info) / *std::max_element(edges.begin(), edges.end());
  TableLayout layout = table_layout(info.type, range);
  if (wanted.table_entries) layout.entries = *wanted.table_entries;
  scene->versions =
      TransferVersions(wanted, headset.profile.refresh, options.data_folder / "transfer_functions",
                       {range, voxel_length_m, layout});
  scene->table = scene->versions.table(0);
  scene->step_units = step_voxels_of(session);
  scene->transfer =
      TransferOnDevice(device, scene->table, scene->step_units, transfer_extras(session.pipeline.at("cast")));
  build_skip_structure(device, session, options, headset, placement, *scene);
  scene->show_transfer(device, 0);
  return scene;
}

}  // namespace brace
