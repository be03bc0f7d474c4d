#include "runtime/verify/caster.hpp"

#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "runtime/host/stage_glsl.hpp"
#include "runtime/raycast/path_choice.hpp"

namespace brace {

namespace {

class InMemory final : public VolumeSource {
 public:
  explicit InMemory(const Volume& volume) : VolumeSource(volume.info), volume_(volume) {}

 private:
  void produce(std::span<std::byte> out, int z_begin, int /*z_count*/) override {
    std::memcpy(out.data(), volume_.voxels.data() + static_cast<std::size_t>(z_begin) * info().slice_bytes(),
                out.size());
  }
  const Volume& volume_;
};

PipelineStage with_defaults(const std::filesystem::path& manifest) {
  PipelineStage stage{read_stage_manifest(manifest), {}};
  for (const StageParameter& parameter : stage.stage.parameters)
    stage.values.push_back(parameter.default_value);
  return stage;
}

void set(PipelineStage& stage, const std::string& name, double value) {
  for (std::size_t i = 0; i < stage.values.size(); ++i)
    if (stage.stage.parameters[i].name == name) stage.values[i] = value;
}

void choose(PipelineStage& stage, const std::string& name, const std::string& choice) {
  for (const StageParameter& parameter : stage.stage.parameters) {
    if (parameter.name != name) continue;
    const auto found = std::find(parameter.choices.begin(), parameter.choices.end(), choice);
    BRACE_CHECK(found != parameter.choices.end());
    set(stage, name, static_cast<double>(found - parameter.choices.begin()));
  }
}

template <typename T>
std::vector<T> download(const gpu::Device& device, const gpu::Buffer& buffer) {
  std::vector<T> values(buffer.size_bytes() / sizeof(T));
  gpu::download_values(device, buffer, std::span<T>(values));
  return values;
}

constexpr int kRow = 64;  // rays across; full work-groups whatever their number

}  // namespace

std::string CastRule::name() const {
  std::string text = integrator;
  if (integrator == "pre-integrated") text += preintegration == "table" ? " (2D table)" : " (1D integral)";
  if (tolerance > 0) text = fmt::format("adaptive {:g}, {}", tolerance, text);
  return text;
}

std::vector<CastRule> all_cast_rules() {
  return {{.integrator = "left"},
          {.integrator = "midpoint-exponential"},
          {.integrator = "linear-source"},
          {.integrator = "pre-integrated", .preintegration = "table"},
          {.integrator = "pre-integrated", .preintegration = "integral"}};
}

struct Caster::Loaded {
  VolumeOnDevice volume;
  VoxelStatistics statistics;
  std::map<std::pair<SkipKind, Occupancy>, std::unique_ptr<SkipStructure>> skips;
};

Caster::Caster(const gpu::Device& device, std::filesystem::path data_folder)
    : device_(device),
      data_folder_(std::move(data_folder)),
      skip_kernels_(std::make_unique<SkipKernels>(device, data_folder_ / "kernels" / "skip")) {}

Caster::~Caster() = default;

void Caster::forget(const Volume& volume) {
  volumes_.erase(&volume);
}

Caster::Loaded& Caster::loaded(const Volume& volume) {
  std::unique_ptr<Loaded>& entry = volumes_[&volume];
  if (entry == nullptr) {
    entry = std::make_unique<Loaded>();
    InMemory source(volume);
    VoxelScan scan(volume.info.type);
    entry->volume = VolumeOnDevice(
        device_, source,
        choose_volume_path(device_, volume.info, VolumePath::automatic, data_folder_, measurements_), &scan);
    entry->statistics = scan.result();
  }
  return *entry;
}

const CastPipeline& Caster::pipeline(const CastCase& wanted, const VolumeOnDevice& volume) {
  const auto defines = volume.defines();
  const CastRule& rule = wanted.rule;
  const std::string key = fmt::format("{} {} {} {} {} {} {}", defines.empty() ? "" : defines.front().first,
                                      rule.integrator, rule.preintegration, rule.step_voxels, rule.tolerance,
                                      rule.termination, to_string(wanted.skip));
  const auto found = pipelines_.find(key);
  if (found != pipelines_.end()) return found->second;
  const std::filesystem::path stages = data_folder_ / "stages";
  const PipelineStage rays = with_defaults(stages / "rays/full_rate/stage.toml");
  const PipelineStage skip = with_defaults(stages / "skip" / to_string(wanted.skip) / "stage.toml");
  PipelineStage cast = with_defaults(stages / "cast/dvr/stage.toml");
  set(cast, "step_voxels", rule.step_voxels);
  set(cast, "termination_opacity", rule.termination);
  set(cast, "tolerance", rule.tolerance);
  choose(cast, "integrator", rule.integrator);
  choose(cast, "preintegration", rule.preintegration);
  const PipelineStage* const chosen[] = {&rays, &cast, &skip};
  StageGlsl glsl = stage_glsl(chosen);
  CastParts parts;
  parts.glsl_folder = data_folder_ / "glsl";
  parts.kernels_folder = data_folder_ / "kernels";
  parts.stages = std::move(glsl.resolve);
  parts.constants = std::move(glsl.constants);
  parts.counters = true;
  CastKernels kernels = compose_cast_kernels(parts, volume);
  kernels.opening = {};  // rays are given, pictures not asked for
  kernels.closing = {};
  return pipelines_.emplace(key, CastPipeline(device_, kernels)).first->second;
}

CastResult Caster::operator()(const CastCase& wanted) {
  Loaded& on = loaded(*wanted.volume);
  const CastPipeline& kernels = pipeline(wanted, on.volume);
  const TransferOnDevice transfer(device_, wanted.table, wanted.rule.step_voxels,
                                  {.integrals = true, .segments = wanted.rule.preintegration == "table"});
  const int rows = (static_cast<int>(wanted.rays.size()) + kRow - 1) / kRow;
  const RayBuffers rays(device_, kRow, rows);
  const EyeTarget target(device_, kRow, rows);
  EyeView eye;
  eye.width_px = kRow;
  eye.height_px = rows;
  CastPipeline::set_eye(device_, target, eye, {}, on.volume, transfer);
  std::vector<glm::vec4> entries(static_cast<std::size_t>(kRow * rows), glm::vec4(0.0f));
  std::vector<glm::vec4> directions(entries.size(), glm::vec4(1.0f, 0.0f, 0.0f, 0.0f));
  for (std::size_t i = 0; i < wanted.rays.size(); ++i) {
    entries[i] = wanted.rays[i].entry;
    directions[i] = wanted.rays[i].direction;
  }
  gpu::upload_values(device_, rays.entries, std::span<const glm::vec4>(entries));
  gpu::upload_values(device_, rays.directions, std::span<const glm::vec4>(directions));
  CastPipeline::Resources resources{on.volume, transfer, rays, target};
  gpu::CommandList commands(device_, "verification");
  if (wanted.skip != SkipKind::none) {
    std::unique_ptr<SkipStructure>& skip = on.skips[{wanted.skip, wanted.occupancy}];
    if (skip == nullptr) {
      SkipOptions options;
      options.kind = wanted.skip;
      options.occupancy = wanted.occupancy;
      options.partitions = 16;
      skip = make_skip_structure(*skip_kernels_, {on.volume, on.statistics, std::span(&wanted.table, 1)},
                                 options);
    }
    skip->update(commands, wanted.table);
    resources.more = skip->bindings();
  }
  kernels.reset_counters(device_);
  commands.barrier();
  kernels.record_cast(commands, resources, {0, 0, kRow, rows});
  commands.barrier();
  gpu::submit_and_wait(commands);
  CastResult result{download<glm::vec4>(device_, rays.colours), download<float>(device_, rays.depths_m),
                    kernels.counted(device_)};
  result.colours.resize(wanted.rays.size());
  result.depths.resize(wanted.rays.size());
  return result;
}

}  // namespace brace
