#include "runtime/raycast/path_choice.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "base/error.hpp"
#include "runtime/host/stage_glsl.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/volume/generators.hpp"

namespace brace {

namespace {

constexpr int kEdgeVoxels = 64;
constexpr int kRepetitions = 4;
constexpr double kClearlyFaster = 1.1;  // less is noise

constexpr std::array kPaths = {VolumePath::sampler, VolumePath::packed};

/// Enough rays for a millisecond, and few enough not to be waited for.
int rays_across(const gpu::DeviceLimits& limits) {
  return limits.is_software ? 160 : 1024;
}

VoxelType measured_type(VoxelType type) {
  return type == VoxelType::int16 ? VoxelType::uint16 : type;  // the same to the device
}

const char* kind_of_voxels(VoxelType type) {
  if (type == VoxelType::float32) return "float voxels";
  return type == VoxelType::uint8 ? "8-bit voxels" : "16-bit voxels";
}

PipelineStage with_defaults(const std::filesystem::path& manifest) {
  PipelineStage stage{read_stage_manifest(manifest), {}};
  for (const StageParameter& parameter : stage.stage.parameters)
    stage.values.push_back(parameter.default_value);
  return stage;
}

/// cast/dvr as it is without settings, and nothing around it.
CastParts plain_parts(const std::filesystem::path& data_folder) {
  const PipelineStage cast = with_defaults(data_folder / "stages/cast/dvr/stage.toml");
  const PipelineStage skip = with_defaults(data_folder / "stages/skip/none/stage.toml");
  const PipelineStage* const stages[] = {&cast, &skip};
  StageGlsl glsl = stage_glsl(stages);
  CastParts parts;
  parts.glsl_folder = data_folder / "glsl";
  parts.kernels_folder = data_folder / "kernels";
  parts.stages = std::move(glsl.resolve);
  parts.constants = std::move(glsl.constants);
  parts.native_rays = true;  // the rays are given, pictures not asked for
  return parts;
}

/// Absorbs so little that every ray goes all the way.
TransferTable thin_table(VoxelType type) {
  const ValueRange range{0.0, full_scale(type)};
  TransferFunction function;
  function.domain = ValueDomain::fraction;
  function.points = {{0.1, {0.2, 0.3, 0.9, 0.0}}, {1.0, {1.0, 0.7, 0.4, 0.02}}};
  return bake(resolve(function, range), table_layout(type, range));
}

/// Parallel rays askew to all axes, from the first slice to where they leave the volume.
void fill_rays(const gpu::Device& device, const RayBuffers& rays) {
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.45, 0.3, 0.84));
  const double edge = kEdgeVoxels;
  std::vector<glm::vec4> entries;
  entries.reserve(static_cast<std::size_t>(rays.across) * static_cast<std::size_t>(rays.down));
  for (int y = 0; y < rays.down; ++y) {
    for (int x = 0; x < rays.across; ++x) {
      const glm::dvec3 entry((x + 0.5) * edge / rays.across, (y + 0.5) * edge / rays.down, 0.0);
      const glm::dvec3 to_faces = (glm::dvec3(edge) - entry) / direction;
      entries.emplace_back(glm::vec3(entry),
                           static_cast<float>(std::min({to_faces.x, to_faces.y, to_faces.z})));
    }
  }
  const std::vector<glm::vec4> directions(entries.size(), glm::vec4(glm::vec3(direction), 0.0f));
  gpu::upload_values(device, rays.entries, std::span<const glm::vec4>(entries));
  gpu::upload_values(device, rays.directions, std::span<const glm::vec4>(directions));
}

/// A path, ready to be timed again.
class PathRig {
 public:
  PathRig(const gpu::Device& device, const CastParts& parts, VoxelType type, VolumePath path,
          const RayBuffers& rays, const EyeTarget& target)
      : commands_(device, "volume path") {
    GeneratorSpec spec{"nested_shells", {kEdgeVoxels, kEdgeVoxels, kEdgeVoxels}, type};
    volume_ = VolumeOnDevice(device, *open_generator(spec), path);
    transfer_ = TransferOnDevice(device, thin_table(type), 0.5);
    pipeline_ = CastPipeline(device, compose_cast_kernels(parts, volume_));
    EyeView eye;
    eye.width_px = rays.across;
    eye.height_px = rays.down;
    CastPipeline::set_eye(device, target, eye, {}, volume_, transfer_);
    commands_.begin_timing("cast");
    pipeline_.record_cast(commands_, {volume_, transfer_, rays, target}, {0, 0, rays.across, rays.down});
    commands_.end_timing();
  }

  double cast_ms() {
    return static_cast<double>(gpu::device_ns(gpu::submit_and_wait(commands_), "cast")) / 1e6;
  }

 private:
  VolumeOnDevice volume_;
  TransferOnDevice transfer_;
  CastPipeline pipeline_;
  gpu::CommandList commands_;
};

/// Shortest times, as kPaths has them; alternately, so that whatever else the machine does meets both.
std::vector<double> time_paths(const gpu::Device& device, const CastParts& parts, VoxelType type) {
  const int across = rays_across(device.limits());
  const RayBuffers rays(device, across, across);
  fill_rays(device, rays);
  std::array<EyeTarget, kPaths.size()> targets;
  std::vector<std::unique_ptr<PathRig>> rigs;
  for (std::size_t i = 0; i < kPaths.size(); ++i) {
    targets[i] = EyeTarget(device, across, across);
    rigs.push_back(std::make_unique<PathRig>(device, parts, type, kPaths[i], rays, targets[i]));
    rigs.back()->cast_ms();  // the driver compiles at the first one
  }
  std::vector<double> times_ms(kPaths.size(), std::numeric_limits<double>::infinity());
  for (int repetition = 0; repetition < kRepetitions; ++repetition)
    for (std::size_t i = 0; i < rigs.size(); ++i)
      times_ms[i] = std::min(times_ms[i], rigs[i]->cast_ms());
  return times_ms;
}

VolumePathChoice faster_path(const gpu::Device& device, const gpu::Measurement& measured) {
  const VolumePath usual = usual_volume_path(device.limits()).path;
  const auto at = [](VolumePath path) { return static_cast<std::size_t>(path == kPaths[1]); };
  const VolumePath other = kPaths[1 - at(usual)];
  const double usual_ms = measured.times_ms[at(usual)], other_ms = measured.times_ms[at(other)];
  const bool other_wins = other_ms * kClearlyFaster < usual_ms;
  const bool close = !other_wins && other_ms < usual_ms * kClearlyFaster;
  const VolumePath taken = other_wins ? other : usual;
  const auto [taken_ms, left_ms] = other_wins ? std::pair(other_ms, usual_ms) : std::pair(usual_ms, other_ms);
  return {taken, fmt::format("{}: chosen by measurement on {}", to_string(taken), device.info().name),
          fmt::format("{} is {:.2f} x as fast as {}{}: {:.2f} ms, {:.2f} ms ({})", to_string(taken),
                      left_ms / taken_ms, to_string(other_wins ? usual : other),
                      close ? ", close enough to leave what is usual" : "", taken_ms, left_ms,
                      measured.origin())};
}

}  // namespace

VolumePathChoice choose_volume_path(const gpu::Device& device, const VolumeInfo& volume, VolumePath wanted,
                                    const std::filesystem::path& data_folder,
                                    gpu::Measurements& measurements) {
  if (const auto forced = forced_volume_path(volume, device.limits(), wanted)) return *forced;
  const VoxelType type = measured_type(volume.type);
  try {
    const CastParts parts = plain_parts(data_folder);
    const gpu::Comparison paths{fmt::format("volume path, {}", kind_of_voxels(type)),
                                gpu::kernel_key(compose_cast_kernels(parts, VolumeOnDevice()).cast),
                                {to_string(kPaths[0]), to_string(kPaths[1])}};
    return faster_path(
        device, measurements.get(device.info(), paths, [&] { return time_paths(device, parts, type); }));
  } catch (const gpu::DeviceLost&) {
    throw;
  } catch (const Error& error) {
    VolumePathChoice choice = usual_volume_path(device.limits());
    choice.reason += fmt::format(" (not measured: {})", error.what());
    return choice;
  }
}

}  // namespace brace
