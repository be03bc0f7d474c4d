#include "runtime/skip/skip_structure.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/skip/structures.hpp"

namespace brace {

namespace {

constexpr SkipKind kinds[] = {SkipKind::none,        SkipKind::block,   SkipKind::distance_map,
                              SkipKind::partitioned, SkipKind::bitmask, SkipKind::octree};

void check_options(const SkipOptions& options) {
  if (options.block_voxels < 2 || options.block_voxels > 16)
    throw input_error("blocks of {} voxels (accepted: 2 to 16)", options.block_voxels);
  if (options.partitions < 1 || options.partitions > max_partitions)
    throw input_error("{} partitions of the values (accepted: 1 to {})", options.partitions, max_partitions);
  if (options.lazy && options.range_minima != RangeMinima::none)
    throw input_error(
        "range_minima and lazy exclude each other: the trees need every map (accepted: one of them)");
}

void check_memory(const gpu::Device& device, const SkipMemory& memory, const SkipOptions& options) {
  const std::uint64_t most =
      options.memory_bytes_max > 0 ? options.memory_bytes_max : device.limits().memory_bytes / 10 * 9;
  const std::uint64_t wanted = memory.kept_bytes + memory.scratch_bytes;
  if (wanted <= most) return;
  throw device_error(
      "skip/{} needs {} MB ({}), but {} MB of {} may be used: fewer partitions or larger blocks fit",
      to_string(options.kind), (wanted + 999'999) / 1'000'000, memory.formula, most / 1'000'000,
      device.info().name);
}

std::string blocks_text(const BlockGrid& grid) {
  return fmt::format("{} x {} x {} blocks", grid.blocks[0], grid.blocks[1], grid.blocks[2]);
}

}  // namespace

const char* to_string(SkipKind kind) {
  switch (kind) {
    case SkipKind::none:
      return "none";
    case SkipKind::block:
      return "block";
    case SkipKind::distance_map:
      return "distance_map";
    case SkipKind::partitioned:
      return "partitioned";
    case SkipKind::bitmask:
      return "bitmask";
    case SkipKind::octree:
      return "octree";
  }
  return "?";
}

SkipKind parse_skip_kind(const std::string& name) {
  std::vector<std::string> names;
  for (const SkipKind kind : kinds) {
    if (name == to_string(kind)) return kind;
    names.emplace_back(to_string(kind));
  }
  throw input_error("skip/{} has no structure (accepted: {})", name, join(names));
}

namespace {

/// skip/occlusion has no structure of its own, but one behind the begin of rays.
SkipKind structure_of(const PipelineStage& stage) {
  if (stage.stage.name != "occlusion") return parse_skip_kind(stage.stage.name);
  for (const StageParameter& parameter : stage.stage.parameters) {
    if (parameter.name != "behind") continue;
    return parse_skip_kind(parameter.choices.at(static_cast<std::size_t>(stage.value("behind"))));
  }
  return SkipKind::none;
}

}  // namespace

SkipOptions skip_options(const PipelineStage& stage, const std::filesystem::path& cache_folder) {
  SkipOptions options;
  options.kind = structure_of(stage);
  const auto value = [&](const char* name, double otherwise) {
    const auto& parameters = stage.stage.parameters;
    const bool known = std::any_of(parameters.begin(), parameters.end(),
                                   [&](const StageParameter& parameter) { return parameter.name == name; });
    return known ? stage.value(name) : otherwise;
  };
  options.block_voxels = static_cast<int>(value("block_voxels", options.block_voxels));
  options.partitions = static_cast<int>(value("partitions", options.partitions));
  options.occupancy = static_cast<Occupancy>(static_cast<int>(value("occupancy", 0)));
  options.placement = static_cast<Partitions>(static_cast<int>(value("placement", 0)));
  options.range_minima = static_cast<RangeMinima>(static_cast<int>(value("range_minima", 0)));
  options.lazy = value("lazy", 0) != 0.0;
  if (value("cache", 0) != 0.0) options.cache_folder = cache_folder;
  return options;
}

SkipMemory skip_memory(const VolumeInfo& volume, const SkipOptions& options) {
  const BlockGrid grid(volume, options.block_voxels);
  const auto n = static_cast<std::uint64_t>(options.partitions);
  const std::uint64_t planes = BitPlanes::bytes_for(grid, options.partitions);
  SkipMemory memory;
  switch (options.kind) {
    case SkipKind::none:
      memory.formula = "nothing";
      break;
    case SkipKind::block:
      memory.kept_bytes = std::uint64_t{grid.plane_words()} * 128 + grid.plane_bytes();
      memory.formula = fmt::format("4 bytes and a bit for each of {}", blocks_text(grid));
      break;
    case SkipKind::distance_map:
      memory.kept_bytes = grid.map_bytes() + grid.plane_bytes();
      memory.formula = fmt::format("a byte and a bit for each of {}", blocks_text(grid));
      break;
    case SkipKind::partitioned: {
      const auto maps =
          static_cast<std::uint64_t>(RangeCover(options.range_minima, options.partitions).maps());
      memory.kept_bytes = (maps + 1) * grid.map_bytes() + (options.lazy ? planes : 0);
      memory.scratch_bytes = options.lazy ? 0 : planes;
      memory.formula =
          fmt::format("{} + 1 maps of {} bytes for {}{}", maps, grid.map_bytes(), blocks_text(grid),
                      options.lazy ? ", and a bit per partition and block" : "");
      break;
    }
    case SkipKind::bitmask:
      memory.kept_bytes = planes + grid.plane_bytes() + grid.map_bytes();
      memory.formula = fmt::format("{} + 1 bit planes of {} bytes and a map of {} for {}", n,
                                   grid.plane_bytes(), grid.map_bytes(), blocks_text(grid));
      break;
    case SkipKind::octree:
      // Levels above the lowest add a seventh, more where edges are odd.
      memory.kept_bytes = grid.count() * ((n + 31) / 32) * 4 * 8 / 7 + 4096;
      memory.scratch_bytes = planes;
      memory.formula = fmt::format("{} bytes for each of {} and an eighth of that level by level above them",
                                   (n + 31) / 32 * 4, blocks_text(grid));
      break;
  }
  return memory;
}

Slack interpolation_slack(const VolumeOnDevice& volume, ValueRange data_range) {
  const bool filtered = volume.path() == VolumePath::sampler;
  Slack slack;
  switch (volume.info().type) {
    case VoxelType::float32:
      // Between neighbours of both signs the larger one's rounding counts.
      if (data_range.min >= 0.0) {
        slack.relative = 0x1p-20;
      } else {
        slack.absolute = std::max(std::abs(data_range.min), std::abs(data_range.max)) * 0x1p-20;
      }
      break;
    case VoxelType::uint8:
      slack.relative = filtered ? 0x1p-16 : 0.0;
      break;
    case VoxelType::int16:
    case VoxelType::uint16:
      slack.relative = filtered ? 0x1p-19 : 0.0;
      slack.zero_shift = volume.info().type == VoxelType::int16 ? 32768.0 : 0.0;
      break;
  }
  return slack;
}

Partitioning make_partitioning(const SkipScene& scene, const SkipOptions& options) {
  const VoxelType type = scene.volume.info().type;
  switch (options.placement) {
    case Partitions::uniform:
      return uniform_partitions(type, scene.statistics.range, options.partitions);
    case Partitions::minimum_apart:
      return minimum_apart(type, scene.statistics.range, options.partitions);
    case Partitions::adaptive:
      return adaptive_partitions(scene.statistics, scene.tables, options.partitions);
  }
  return {};
}

SkipStructure::SkipStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options)
    : kernels_(&kernels),
      grid_(scene.volume.info(), options.block_voxels),
      slack_(interpolation_slack(scene.volume, scene.statistics.range)),
      params_buffer_(kernels.device(), "skip parameters", sizeof(BraceSkipParams), gpu::Memory::upload) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    params_.blocks[axis] = grid_.blocks[axis];
  params_.blocks[3] = static_cast<std::uint32_t>(grid_.edge);
  params_.edge[0] = static_cast<float>(grid_.edge);
  params_.edge[1] = 1.0f / static_cast<float>(grid_.edge);
  params_.map[0] = grid_.row_quads() * 4;
  params_.map[1] = params_.map[0] * grid_.blocks[1];
  params_.plane[0] = grid_.row_words();
  params_.plane[1] = params_.plane[0] * grid_.blocks[1];
  write_params(params_);
}

void SkipStructure::bind_map(brace_skip_map kind, const gpu::Buffer& buffer, const gpu::TexelBuffer& words) {
  map_kind_ = kind;
  map_words_ = &buffer;
  bindings_ = {gpu::bind(10, words), gpu::bind(11, params_buffer_)};
}

void SkipStructure::write_params(const BraceSkipParams& params) {
  gpu::upload_values(device(), params_buffer_, std::span<const BraceSkipParams>(&params, 1));
}

std::unique_ptr<SkipStructure> make_skip_structure(SkipKernels& kernels, const SkipScene& scene,
                                                   const SkipOptions& options, const Progress& progress) {
  check_options(options);
  check_memory(kernels.device(), skip_memory(scene.volume.info(), options), options);
  switch (options.kind) {
    case SkipKind::none:
      break;
    case SkipKind::block:
      return std::make_unique<BlockStructure>(kernels, scene, options, progress);
    case SkipKind::distance_map:
      return std::make_unique<DistanceMapStructure>(kernels, scene, options);
    case SkipKind::partitioned:
      return std::make_unique<PartitionedStructure>(kernels, scene, options, progress);
    case SkipKind::bitmask:
      return std::make_unique<BitmaskStructure>(kernels, scene, options, progress);
    case SkipKind::octree:
      return std::make_unique<OctreeStructure>(kernels, scene, options, progress);
  }
  return nullptr;
}

}  // namespace brace
