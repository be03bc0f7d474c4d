// From a session's stages to the first frame: kernels composed, compiled or taken from the cache, pipelines
// made, one eye cast.
#include <chrono>
#include <random>

#include "base/error.hpp"
#include "bench/host.hpp"
#include "runtime/host/stage_glsl.hpp"
#include "runtime/raycast/cast_pipeline.hpp"

namespace brace {

namespace {

PipelineStage with_defaults(const std::filesystem::path& manifest) {
  PipelineStage stage{read_stage_manifest(manifest), {}};
  for (const StageParameter& parameter : stage.stage.parameters)
    stage.values.push_back(parameter.default_value);
  return stage;
}

/// A folder of its own, so that the first start finds nothing.
struct EmptyFolder {
  EmptyFolder() {
    std::random_device seed;
    path = std::filesystem::temp_directory_path() / fmt::format("brace-bench-host-{}", seed());
    std::filesystem::create_directories(path);
  }
  ~EmptyFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  EmptyFolder(const EmptyFolder&) = delete;
  EmptyFolder& operator=(const EmptyFolder&) = delete;
  std::filesystem::path path;
};

}  // namespace

HostBenchStart bench_start(const gpu::Device& device, const std::filesystem::path& data_folder) {
  const VolumeOnDevice volume(device, *open_volume("generator:nested_shells:32"));
  TransferTable table{{0.0, 255.0}, std::vector<std::array<double, 4>>(256, {1.0, 1.0, 1.0, 0.05})};
  const TransferOnDevice transfer(device, table, 0.5);
  EyeView view;
  view.width_px = view.height_px = 64;
  view.world_from_eye.position = {0.0, 0.0, 1.0};
  const RayBuffers rays(device, 64, 64);
  const EyeTarget target(device, 64, 64);
  CastPipeline::set_eye(device, target, view, {{}, 0.5}, volume, transfer);

  const EmptyFolder cache;
  gpu::CommandList commands(device, "first frame");
  const auto start = [&] {
    const auto begin = std::chrono::steady_clock::now();
    const PipelineStage cast = with_defaults(data_folder / "stages/cast/dvr/stage.toml");
    const PipelineStage opening = with_defaults(data_folder / "stages/rays/full_rate/stage.toml");
    const PipelineStage* const chosen[] = {&cast, &opening};
    StageGlsl glsl = stage_glsl(chosen);
    CastParts parts;
    parts.glsl_folder = data_folder / "glsl";
    parts.kernels_folder = data_folder / "kernels";
    parts.stages = std::move(glsl.resolve);
    parts.constants = std::move(glsl.constants);
    const CastPipeline pipeline(device, compose_cast_kernels(parts, volume),
                                {.use_cache = true, .cache_folder = cache.path});
    commands.reset();
    pipeline.record(commands, {volume, transfer, rays, target});
    (void)gpu::submit_and_wait(commands);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  HostBenchStart result;
  result.cold_s = start();
  result.warm_s = start();
  return result;
}

}  // namespace brace
