#include "runtime/raycast/native_steps.hpp"

#include <cmath>

#include "gpu/gpu_fixture.hpp"
#include "runtime/conformance/bench_scene.hpp"
#include "stages.hpp"

namespace brace {
namespace {

struct Results {
  std::vector<float> colours, depths_m;
  std::vector<std::uint32_t> image;
  EyeCastOutcome outcome;
};

class NativeSteps : public gpu::GpuTest {
 protected:
  static CheckOptions options() {
    CheckOptions options;
    options.device = &device();
    options.data_folder = BRACE_DATA_FOLDER;
    return options;
  }

  static Results cast(const CastPipeline& pipeline, const BenchScene& scene, BenchView at,
                      const NativeStage* rays, const NativeStage* native_cast) {
    const RayBuffers buffers(device(), 24, 16);
    const EyeTarget target(device(), 24, 16);
    const EyeView view = bench_eye(at, usual_size);
    CastPipeline::set_eye(device(), target, view, scene.placement, scene.volume, scene.transfer);
    const CastPipeline::Resources resources{scene.volume, scene.transfer, buffers, target};
    EyeCast eye{device(), pipeline, resources, view};
    eye.rays = rays;
    eye.cast = native_cast;
    gpu::CommandList commands(device(), "eye");
    HostRays host;
    Results results;
    results.outcome = cast_eye(eye, commands, host);
    results.colours.resize(4 * 24 * 16);
    results.depths_m.resize(24 * 16);
    results.image.resize(24 * 16);
    gpu::download_values(device(), buffers.colours, std::span<float>(results.colours));
    gpu::download_values(device(), buffers.depths_m, std::span<float>(results.depths_m));
    gpu::download_values(device(), target.image, std::span<std::uint32_t>(results.image));
    return results;
  }
};

TEST_F(NativeSteps, ReferenceCastOnTheHostAgreesWithDvrOnTheDevice) {
  const BenchScene scene(device());
  PipelineStage dvr = with_defaults(
      stage_from(std::filesystem::path(BRACE_DATA_FOLDER) / "stages/cast/dvr/stage.toml", "cast", "dvr"));
  PipelineStage reference = with_defaults(example_stage("reference_cast.so", "cast", "reference"));
  ASSERT_EQ(dvr.stage.parameters[1].name, "termination_opacity");
  dvr.values[1] = reference.values[1] = 1.0;
  const CastPipeline kernels = bench_pipeline(options(), scene, dvr, {{"rays", plain_rays_snippet}});
  NativeStage native(reference);
  const StageActivation activation(
      activation_input(device(), scene.volume, scene.placement, scene.table, BenchScene::step_units, 24, 16));
  native.activate(activation.get());
  for (const BenchView view : bench_views) {
    const Results fast = cast(kernels, scene, view, nullptr, nullptr);
    const Results oracle = cast(kernels, scene, view, nullptr, &native);
    double worst = 0.0, squares = 0.0, visible = 0.0;
    for (std::size_t i = 0; i < fast.colours.size(); ++i) {
      const double difference =
          std::abs(static_cast<double>(fast.colours[i]) - static_cast<double>(oracle.colours[i]));
      worst = std::max(worst, difference);
      squares += difference * difference;
      visible = std::max(visible, static_cast<double>(oracle.colours[i]));
    }
    EXPECT_LE(worst, 1.0 / 255.0);
    EXPECT_LE(std::sqrt(squares / static_cast<double>(fast.colours.size())), 1e-3);
    for (std::size_t ray = 0; ray < fast.depths_m.size(); ++ray) {
      if (std::isinf(oracle.depths_m[ray])) continue;
      EXPECT_NEAR(fast.depths_m[ray], oracle.depths_m[ray], 1e-4) << ray;
    }
    if (view == BenchView::away) continue;
    EXPECT_GT(visible, 0.1);

    EXPECT_EQ(oracle.outcome.counted.rays, 24u * 16u);
    EXPECT_GT(oracle.outcome.counted.samples, 1000u);
  }
}

TEST_F(NativeSteps, NativeRaysReplaceBothBraces) {
  const BenchScene scene(device());
  const PipelineStage blank = with_defaults(broken_stage("rays", BROKEN_NONE));
  const CastPipeline kernels =
      bench_pipeline(options(), scene, blank, {{"rays", plain_rays_snippet}, {"cast", plain_cast_snippet}});
  NativeStage native(blank);
  const StageActivation activation(
      activation_input(device(), scene.volume, scene.placement, scene.table, BenchScene::step_units, 24, 16));
  native.activate(activation.get());
  const Results results = cast(kernels, scene, BenchView::outside, &native, nullptr);
  for (const float value : results.colours)
    ASSERT_EQ(value, 0.0f);  // it opens no rays …
  for (const std::uint32_t pixel : results.image)
    ASSERT_EQ(pixel, 0x80000000u);  // … and closes to half opaque
}

TEST_F(NativeSteps, CastingOnTheHostAllocatesNothingOnceWarm) {
  const BenchScene scene(device());
  const PipelineStage stage = with_defaults(broken_stage("cast", BROKEN_NONE));
  const CastPipeline pipeline =
      bench_pipeline(options(), scene, stage, {{"rays", plain_rays_snippet}, {"cast", empty_cast_snippet}});
  NativeStage native(stage);
  const StageActivation activation(
      activation_input(device(), scene.volume, scene.placement, scene.table, BenchScene::step_units, 24, 16));
  native.activate(activation.get());
  const RayBuffers buffers(device(), 24, 16);
  const EyeTarget target(device(), 24, 16);
  const EyeView view = bench_eye(BenchView::outside, usual_size);
  CastPipeline::set_eye(device(), target, view, scene.placement, scene.volume, scene.transfer);
  const CastPipeline::Resources resources{scene.volume, scene.transfer, buffers, target};
  EyeCast eye{device(), pipeline, resources, view};
  eye.cast = &native;
  HostRays host;
  WorkCounts counted;
  execute_cast(eye, {0, 0, 24, 16}, host, counted);
  const std::uint64_t before = allocations_of_this_thread().allocations;
  for (int i = 0; i < 100; ++i)
    execute_cast(eye, {0, 0, 24, 16}, host, counted);
  EXPECT_EQ(allocations_of_this_thread().allocations, before);
}

}  // namespace
}  // namespace brace
