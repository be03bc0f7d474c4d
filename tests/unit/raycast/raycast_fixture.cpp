#include "tests/unit/raycast/raycast_fixture.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "runtime/host/stage_glsl.hpp"

namespace brace {

namespace {

const std::filesystem::path kSource = BRACE_SOURCE_DIR;
constexpr double kLightStep = 0.8;  // of shadings by additional samples
const glm::dvec3 kLight = glm::normalize(glm::dvec3(0.5, 1.0, 0.3));

PipelineStage stage_of(const char* id) {
  PipelineStage stage{read_stage_manifest(kSource / "stages" / id / "stage.toml"), {}};
  for (const StageParameter& parameter : stage.stage.parameters)
    stage.values.push_back(parameter.default_value);
  return stage;
}

PipelineStage cast_stage(const CastSettings& settings) {
  PipelineStage cast = stage_of("cast/dvr");
  const auto set = [&](const std::string& name, double value) {
    for (std::size_t i = 0; i < cast.values.size(); ++i)
      if (cast.stage.parameters[i].name == name) cast.values[i] = value;
  };
  const auto choose = [&](const std::string& name, const std::string& choice) {
    for (const StageParameter& parameter : cast.stage.parameters) {
      if (parameter.name != name) continue;
      const auto found = std::find(parameter.choices.begin(), parameter.choices.end(), choice);
      ASSERT_NE(found, parameter.choices.end()) << choice;
      set(name, static_cast<double>(found - parameter.choices.begin()));
    }
  };
  set("step_voxels", settings.step_voxels);
  set("termination_opacity", settings.termination);
  set("tolerance", settings.tolerance);
  set("step_voxels_min", settings.step_voxels_min);
  set("step_voxels_max", settings.step_voxels_max);
  choose("integrator", settings.integrator);
  choose("preintegration", settings.preintegration);
  return cast;
}

template <typename T>
std::vector<T> download(const gpu::Device& device, const gpu::Buffer& buffer) {
  std::vector<T> values(buffer.size_bytes() / sizeof(T));
  gpu::download_values(device, buffer, std::span<T>(values));
  return values;
}

template <typename A, typename B>
Difference compare(const A& a, const B& b) {
  Difference result;
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int c = 0; c < 4; ++c) {
      const double d = std::abs(static_cast<double>(a[i][c]) - static_cast<double>(b[i][c]));
      result.max = std::isnan(d) ? INFINITY : std::max(result.max, d);
      squares += d * d;
    }
  }
  result.rms = std::sqrt(squares / static_cast<double>(4 * std::max<std::size_t>(a.size(), 1)));
  return result;
}

}  // namespace

void MemorySource::produce(std::span<std::byte> out, int z_begin, int /*z_count*/) {
  std::memcpy(out.data(), volume_.voxels.data() + static_cast<std::size_t>(z_begin) * info().slice_bytes(),
              out.size());
}

Volume load(const std::string& path_or_generator) {
  return load_volume(*open_volume(path_or_generator));
}

TransferTable table_over(const Volume& volume, ValueRange range, std::vector<TransferPoint> points) {
  TransferFunction function;
  function.source = "made by the test";
  function.domain = ValueDomain::fraction;
  function.points = std::move(points);
  return bake(resolve(function, range), table_layout(volume.info.type, range));
}

TransferTable smooth_table(const Volume& volume, ValueRange range) {
  return table_over(volume, range,
                    {{0.2, {0.2, 0.3, 0.9, 0.0}}, {0.5, {0.2, 0.9, 0.3, 0.05}}, {1.0, {1.0, 0.7, 0.4, 0.4}}});
}

EyeView look_at_centre(const glm::dvec3& position, int width_px, int height_px, double fov_rad) {
  EyeView eye;
  const glm::dvec3 back = glm::normalize(position);
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), back));
  eye.world_from_eye.orientation = glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back));
  eye.world_from_eye.position = position;
  const double half = std::tan(0.5 * fov_rad);
  eye.tan_left = eye.tan_bottom = -half;
  eye.tan_right = eye.tan_top = half;
  eye.width_px = width_px;
  eye.height_px = height_px;
  return eye;
}

reference::Options reference_options(const CastSettings& settings) {
  reference::Options options{settings.step_voxels, settings.termination, std::nullopt};
  if (settings.phong) options.phong = reference::Phong{};
  if (settings.shadow_ao || settings.light_samples >= 0)
    options.sampled = {settings.shadow_ao, settings.light_samples, kLightStep, kLight};
  if (settings.integrator == "left") options.rule = reference::Rule::left;
  if (settings.integrator == "linear-source") options.rule = reference::Rule::linear_source;
  if (settings.integrator == "pre-integrated") options.rule = reference::Rule::pre_integrated;
  return options;
}

Difference difference(const std::vector<glm::vec4>& colours, const reference::Picture& picture) {
  return compare(colours, picture.colours);
}

Difference difference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
  return compare(a, b);
}

bool is_bounded(const std::vector<glm::vec4>& colours) {
  return std::all_of(colours.begin(), colours.end(), [](const glm::vec4& c) {
    bool fine = c.a >= 0.0f && c.a <= 1.0f;
    for (int i = 0; i < 3; ++i)
      fine = fine && c[i] >= 0.0f && c[i] <= c.a;
    return fine;
  });
}

CastParts RaycastTest::parts(const CastSettings& settings) {
  CastParts parts;
  parts.glsl_folder = kSource / "plugins/abi/glsl";
  parts.kernels_folder = kSource / "runtime/raycast/kernels";
  const PipelineStage rays = stage_of("rays/full_rate"), cast = cast_stage(settings),
                      skip = stage_of("skip/none");
  const PipelineStage* const stages[] = {&rays, &cast, &skip};
  StageGlsl glsl = stage_glsl(stages);
  parts.stages = std::move(glsl.resolve);
  parts.constants = std::move(glsl.constants);
  parts.phong = settings.phong;
  using Kind = SampledShading::Kind;
  parts.sampled.kind = settings.shadow_ao            ? Kind::shadow_ao
                       : settings.light_samples >= 0 ? Kind::random_lights
                                                     : Kind::none;
  parts.sampled.samples = std::max(settings.light_samples, 0);
  parts.sampled.step_units = kLightStep;
  parts.sampled.steps_of_table = kLightStep / settings.step_voxels;
  parts.sampled.light = kLight;
  parts.counters = settings.counters;
  return parts;
}

gpu::CompileOptions RaycastTest::compile_options() {
  gpu::CompileOptions options;
  options.cache_folder = std::filesystem::path(testing::TempDir()) / "brace-raycast-test-spirv";
  return options;
}

const CastPipeline& RaycastTest::pipeline(const VolumeOnDevice& volume, const CastSettings& settings) {
  const auto defines = volume.defines();
  const Key key{defines.empty() ? "" : defines.front().first, settings};
  auto found = pipelines_.find(key);
  if (found == pipelines_.end()) {
    const CastKernels kernels = compose_cast_kernels(parts(settings), volume);
    found = pipelines_.emplace(key, CastPipeline(device(), kernels, compile_options())).first;
  }
  return found->second;
}

VolumeOnDevice RaycastTest::on_device(const Volume& volume, VolumePath path) {
  MemorySource source(volume);
  return VolumeOnDevice(device(), source, path);
}

Shot RaycastTest::shoot(const Volume& volume, const TransferTable& table, const EyeView& eye,
                        const VolumePlacement& placement, const CastSettings& settings, VolumePath path) {
  return shoot(on_device(volume, path), table, eye, placement, settings);
}

Shot RaycastTest::shoot(const VolumeOnDevice& volume, const TransferTable& table, const EyeView& eye,
                        const VolumePlacement& placement, const CastSettings& settings) {
  const CastPipeline& cast = pipeline(volume, settings);
  const TransferOnDevice transfer(device(), table, settings.step_voxels,
                                  {.integrals = true, .segments = true});
  const RayBuffers rays(device(), eye.width_px, eye.height_px);
  const EyeTarget target(device(), eye.width_px, eye.height_px);
  CastPipeline::set_eye(device(), target, eye, placement, volume, transfer);
  cast.reset_counters(device());
  gpu::CommandList commands(device(), "shot");
  cast.record(commands, {volume, transfer, rays, target});
  gpu::submit_and_wait(commands);
  return {download<glm::vec4>(device(), rays.colours),
          download<float>(device(), rays.depths_m),
          download<std::uint32_t>(device(), target.image),
          download<float>(device(), target.depth),
          download<glm::vec4>(device(), rays.entries),
          download<glm::vec4>(device(), rays.directions),
          cast.counted(device())};
}

std::vector<glm::vec4> RaycastTest::cast_rays(const VolumeOnDevice& volume, const TransferTable& table,
                                              const std::vector<glm::vec4>& entries,
                                              const std::vector<glm::vec4>& directions,
                                              const CastSettings& settings) {
  const auto count = static_cast<int>(entries.size());
  const CastPipeline& cast = pipeline(volume, settings);
  const TransferOnDevice transfer(device(), table, settings.step_voxels,
                                  {.integrals = true, .segments = true});
  const RayBuffers rays(device(), count, 1);
  const EyeTarget target(device(), count, 1);
  CastPipeline::set_eye(device(), target, look_at_centre({0, 0, 2}, count, 1), {}, volume, transfer);
  gpu::upload_values(device(), rays.entries, std::span<const glm::vec4>(entries));
  gpu::upload_values(device(), rays.directions, std::span<const glm::vec4>(directions));
  gpu::CommandList commands(device(), "rays of the test");
  cast.record_cast(commands, {volume, transfer, rays, target}, {0, 0, count, 1});
  commands.barrier();
  gpu::submit_and_wait(commands);
  return download<glm::vec4>(device(), rays.colours);
}

std::filesystem::path shared_volumes() {
  const char* shared = std::getenv("BRACE_SHARED_DIR");
  const auto folder =
      (shared ? std::filesystem::path(shared) : kSource.parent_path() / "shared") / "data/volumes";
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

std::filesystem::path preset_folder() {
  return kSource / "runtime/volume/transfer_functions";
}

}  // namespace brace
