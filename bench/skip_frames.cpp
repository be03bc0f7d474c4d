#include "bench/skip_frames.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <glm/gtc/quaternion.hpp>

#include "bench/skip_scenes.hpp"
#include "runtime/host/stage_glsl.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/skip/choose_skip.hpp"

namespace brace::bench {

namespace {

constexpr double step_voxels = 0.5;
constexpr double pi = 3.14159265358979323846;

/// A volume and what it is cast with; the pipelines are made as they are asked for.
class FrameBench {
 public:
  FrameBench(const gpu::Device& device, const VolumeOnDevice& volume, const SkipBenchOptions& options)
      : device_(device),
        volume_(volume),
        options_(options),
        target_(device, options.viewport_px, options.viewport_px),
        rays_(device, options.viewport_px, options.viewport_px) {}

  /// Mean device time of a frame's casting over all views, ms.
  double frame_ms(SkipKind kind, bool terminated, const TransferOnDevice& transfer,
                  const SkipStructure* skip) {
    const CastPipeline& pipeline = pipeline_for(kind, terminated, false);
    double sum_ms = 0;
    for (int view = 0; view < options_.views; ++view) {
      double least_ms = 1e30;
      for (int repeat = 0; repeat < 2; ++repeat)
        least_ms = std::min(least_ms, cast(pipeline, view, transfer, skip));
      sum_ms += least_ms;
    }
    return sum_ms / options_.views;
  }

  WorkCounts counted(SkipKind kind, const TransferOnDevice& transfer, const SkipStructure* skip) {
    const CastPipeline& pipeline = pipeline_for(kind, true, true);
    pipeline.reset_counters(device_);
    for (int view = 0; view < options_.views; ++view)
      cast(pipeline, view, transfer, skip);
    return pipeline.counted(device_);
  }

 private:
  EyeView eye_at(int view) const {
    // Two full rotations, so that the second half of the views lies between those of the first.
    const double angle = 4 * pi * (view + (view >= (options_.views + 1) / 2 ? 0.25 : 0.0)) / options_.views;
    const auto& dims = volume_.info().dims;
    const double longest = *std::max_element(dims.begin(), dims.end());
    const double height_m = dims[1] / longest;
    const double half_angle = 15.0 * pi / 180.0;
    const double distance_m = height_m / 2 / std::tan(half_angle) + 0.5;
    EyeView eye;
    eye.world_from_eye.orientation = glm::dquat(std::cos(angle / 2), 0, std::sin(angle / 2), 0);
    eye.world_from_eye.position = {distance_m * std::sin(angle), 0, distance_m * std::cos(angle)};
    eye.tan_right = eye.tan_top = std::tan(half_angle);
    eye.tan_left = eye.tan_bottom = -eye.tan_right;
    eye.width_px = eye.height_px = options_.viewport_px;
    return eye;
  }

  double cast(const CastPipeline& pipeline, int view, const TransferOnDevice& transfer,
              const SkipStructure* skip) {
    CastPipeline::set_eye(device_, target_, eye_at(view), {}, volume_, transfer);
    CastPipeline::Resources resources{volume_, transfer, rays_, target_};
    if (skip != nullptr) resources.more = skip->bindings();
    commands_ = gpu::CommandList(device_, "frame");
    pipeline.record(commands_, resources);
    return static_cast<double>(gpu::device_ns(gpu::submit_and_wait(commands_), "cast")) * 1e-6;
  }

  PipelineStage stage(const std::string& id) const {
    PipelineStage chosen{read_stage_manifest(options_.data_folder / "stages" / id / "stage.toml"), {}};
    for (const StageParameter& parameter : chosen.stage.parameters)
      chosen.values.push_back(parameter.default_value);
    return chosen;
  }

  const CastPipeline& pipeline_for(SkipKind kind, bool terminated, bool counters) {
    const std::string key = fmt::format("{} {} {}", to_string(kind), terminated, counters);
    const auto found = pipelines_.find(key);
    if (found != pipelines_.end()) return found->second;
    const PipelineStage rays = stage("rays/full_rate"), skip = stage(std::string("skip/") + to_string(kind));
    PipelineStage cast_stage = stage("cast/dvr");
    cast_stage.values[0] = step_voxels;
    cast_stage.values[1] = terminated ? 0.98 : 1.0;  // as in the paper
    const PipelineStage* const stages[] = {&rays, &cast_stage, &skip};
    const StageGlsl glsl = stage_glsl(stages);
    const CastParts parts{options_.data_folder / "glsl",
                          options_.data_folder / "kernels",
                          glsl.resolve,
                          glsl.constants,
                          false,
                          counters};
    return pipelines_.emplace(key, CastPipeline(device_, compose_cast_kernels(parts, volume_))).first->second;
  }

  const gpu::Device& device_;
  const VolumeOnDevice& volume_;
  const SkipBenchOptions& options_;
  EyeTarget target_;
  RayBuffers rays_;
  gpu::CommandList commands_;
  std::map<std::string, CastPipeline> pipelines_;
};

}  // namespace

std::vector<NamedTable> paper_tables() {
  std::vector<NamedTable> tables;
  for (int tf = 1; tf <= 6; ++tf)
    tables.push_back({tf, skip_table(tf)});
  return tables;
}

std::vector<NamedTable> tables_for(const VoxelStatistics& statistics) {
  std::vector<NamedTable> tables;
  for (const int tf : {0, 1, 3}) {
    NamedTable named{tf, skip_table(tf == 0 ? 2 : tf)};
    named.table.range = statistics.range;
    // From the bottom up until no more than 1 % of the voxels show.
    for (std::size_t i = 0; tf == 0 && occupied_fraction(statistics, named.table) > 0.01; ++i)
      named.table.entries.at(i)[3] = 0.0;
    tables.push_back(std::move(named));
  }
  return tables;
}

std::vector<FrameVariant> basic_variants() {
  std::vector<FrameVariant> variants = all_variants();
  variants.resize(3);
  return variants;
}

std::vector<FrameVariant> all_variants() {
  std::vector<FrameVariant> result;
  const auto add = [&](std::string name, SkipKind kind, int partitions,
                       Partitions placement = Partitions::uniform) {
    SkipOptions options;
    options.kind = kind;
    options.partitions = partitions;
    options.placement = placement;
    result.push_back({std::move(name), options});
  };
  add("none", SkipKind::none, 1);
  add("block", SkipKind::block, 1);
  add("distance_map", SkipKind::distance_map, 1);
  add("partitioned 32", SkipKind::partitioned, 32);
  add("partitioned 64", SkipKind::partitioned, 64);
  add("partitioned 32, minimum apart", SkipKind::partitioned, 32, Partitions::minimum_apart);
  add("bitmask 64", SkipKind::bitmask, 64);
  add("octree 64", SkipKind::octree, 64);
  return result;
}

std::vector<SkipFrameRow> measure_frames(const gpu::Device& device, SkipKernels& kernels,
                                         const std::string& scene, const VolumeOnDevice& volume,
                                         const VoxelStatistics& statistics,
                                         std::span<const NamedTable> tables,
                                         const std::vector<FrameVariant>& variants,
                                         const SkipBenchOptions& options) {
  FrameBench bench(device, volume, options);
  std::map<int, std::string> chosen;
  for (const NamedTable& named : tables) {
    const double occupied = occupied_blocks(kernels, {volume, statistics}, named.table);
    chosen[named.tf] = to_string(choose_skip({volume.info(), occupied, named.table}).options.kind);
  }
  std::vector<SkipFrameRow> rows;
  for (const FrameVariant& variant : variants) {
    if (skip_memory(volume.info(), variant.options).kept_bytes > options.memory_bytes_max) continue;
    const auto structure = make_skip_structure(kernels, {volume, statistics}, variant.options);
    for (const auto& [tf, table] : tables) {
      if (structure) {
        gpu::CommandList commands(device, "update");
        structure->update(commands, table);
        gpu::submit_and_wait(commands);
      }
      const TransferOnDevice transfer(device, table, step_voxels);
      SkipFrameRow row{scene, tf, variant.name};
      row.chosen = chosen.at(tf) == variant.name;
      row.ms = bench.frame_ms(variant.options.kind, true, transfer, structure.get());
      row.ms_without_termination = bench.frame_ms(variant.options.kind, false, transfer, structure.get());
      const WorkCounts work = bench.counted(variant.options.kind, transfer, structure.get());
      row.samples_m = static_cast<double>(work.samples) / options.views * 1e-6;
      row.skip_steps_m = static_cast<double>(work.skip_steps) / options.views * 1e-6;
      rows.push_back(row);
    }
    if (options.progress) options.progress(fmt::format("{}: frames with {} done", scene, variant.name));
  }
  return rows;
}

}  // namespace brace::bench
