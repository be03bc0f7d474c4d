#include "runtime/replay/scene.hpp"

#include <algorithm>

#include "runtime/report/progress.hpp"

namespace brace {

namespace {

TransferFunction session_transfer_function(const Session::Scene& scene, ValueRange data_range,
                                           const std::filesystem::path& data_folder) {
  TransferFunction tf = load_transfer_function(scene.transfer_function, data_folder / "transfer_functions");
  if (!scene.window && !scene.level) return tf;
  const double width = scene.window.value_or(data_range.max - data_range.min);
  const double level = scene.level.value_or(0.5 * (data_range.min + data_range.max));
  return with_window(tf, {.level = level, .width = width});
}

}  // namespace

double step_voxels_of(const Session& session) {
  const PipelineStage& cast = session.pipeline.at("cast");
  for (const StageParameter& parameter : cast.stage.parameters) {
    if (parameter.name == "step_voxels") return cast.value("step_voxels");
  }
  return 0.5;
}

SceneOnDevice load_scene(const gpu::Device& device, const Session& session,
                         const std::filesystem::path& data_folder) {
  const Session::Scene& wanted = session.scene;
  OpenOptions options;
  options.non_finite = wanted.nan == "empty" ? NonFinitePolicy::treat_as_empty : NonFinitePolicy::reject;
  const std::unique_ptr<VolumeSource> source = open_volume(wanted.volume, options);

  ProgressMeter meter("loading", 1000, "‰");
  VoxelScan scan(source->info().type);
  SceneOnDevice scene;
  scene.volume =
      VolumeOnDevice(device, *source, parse_volume_path(wanted.data_path), &scan,
                     [&](double fraction) { meter.update(static_cast<std::uint64_t>(fraction * 1000.0)); });
  meter.finish();
  scene.statistics = scan.result();

  const VolumeInfo& info = scene.volume.info();
  const ValueRange range = scene.statistics.range;
  const TransferFunction tf = session_transfer_function(wanted, range, data_folder);
  const auto edges = box_size(info);
  const double voxel_length_m =
      wanted.size_m * voxel_length(info) / *std::max_element(edges.begin(), edges.end());
  TableLayout layout = table_layout(info.type, range);
  if (wanted.table_entries) layout.entries = *wanted.table_entries;
  scene.table = bake(resolve(tf, range, voxel_length_m), layout);
  scene.transfer = TransferOnDevice(device, scene.table, step_voxels_of(session));
  return scene;
}

}  // namespace brace
