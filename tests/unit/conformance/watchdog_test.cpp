#include "runtime/host/watchdog.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "gpu/gpu_fixture.hpp"
#include "runtime/conformance/bench_scene.hpp"
#include "stages.hpp"

namespace brace {
namespace {

const std::filesystem::path kernels = std::filesystem::path(BRACE_DATA_FOLDER) / "kernels";

class WatchdogTest : public gpu::GpuTest {
 protected:
  /// Casts frames 7 and 8 with a stage of the broken library under a watchdog.
  static std::vector<WatchdogReport> watch(int defect, WatchdogLevel level) {
    CheckOptions options;
    options.device = &device();
    options.data_folder = BRACE_DATA_FOLDER;
    const BenchScene scene(device());
    const PipelineStage stage = with_defaults(broken_stage("cast", defect));
    const CastPipeline pipeline =
        bench_pipeline(options, scene, stage, {{"rays", plain_rays_snippet}, {"cast", empty_cast_snippet}});
    const RayBuffers rays(device(), 24, 16, level == WatchdogLevel::full ? watchdog_guard_bytes : 0);
    const EyeTarget target(device(), 24, 16);
    const EyeView view = bench_eye(BenchView::outside, usual_size);
    NativeStage native(stage);
    StageActivation activation(activation_input(device(), scene.volume, scene.placement, scene.table,
                                                BenchScene::step_units, 24, 16));
    native.activate(activation.get());
    Watchdog watchdog(device(), level, kernels);
    watchdog.arm_guard(rays.colours);
    watchdog.arm_guard(rays.depths_m);
    gpu::CommandList commands(device(), "watched");
    HostRays host;
    CastPipeline::set_eye(device(), target, view, scene.placement, scene.volume, scene.transfer);
    const CastPipeline::Resources resources{scene.volume, scene.transfer, rays, target};
    for (const std::uint64_t frame : {7u, 8u}) {
      EyeCast eye{device(), pipeline, resources, view};
      eye.frame = frame;
      eye.cast = &native;
      eye.watchdog = &watchdog;
      eye.cast_deadline_ns = 20'000'000;
      (void)cast_eye(eye, commands, host);
    }
    return watchdog.reports();
  }

  static void expect_only(int defect, const char* clause) {
    const auto reports = watch(defect, WatchdogLevel::full);
    ASSERT_EQ(reports.size(), 1u) << clause;
    EXPECT_EQ(reports[0].stage, "cast/broken");
    EXPECT_EQ(reports[0].clause, clause);
    EXPECT_GE(reports[0].count, 2u);
    EXPECT_EQ(reports[0].first_frame, 7);
  }
};

TEST_F(WatchdogTest, SoundStageGivesNoReport) {
  EXPECT_TRUE(watch(BROKEN_NONE, WatchdogLevel::full).empty());
}

TEST_F(WatchdogTest, EachFaultIsAttributedToItsStageAndClause) {
  expect_only(BROKEN_NOT_A_NUMBER, "NaN or Inf in a result");
  expect_only(BROKEN_COLOUR_OVER_OPACITY, "colour outside [0, opacity]");
  expect_only(BROKEN_OPACITY_OVER_ONE, "opacity outside [0, 1]");
  expect_only(BROKEN_BAD_DEPTH, "depth below zero");
  expect_only(BROKEN_WRITES_BEHIND_BUFFER, "written outside its area");
  expect_only(BROKEN_CHANGES_INPUT, "input overwritten");
  expect_only(BROKEN_SLOW, "over the deadline");
}

TEST_F(WatchdogTest, LevelOutputsLeavesMemoryAlone) {
  EXPECT_TRUE(watch(BROKEN_CHANGES_INPUT, WatchdogLevel::outputs).empty());
  EXPECT_EQ(watch(BROKEN_NOT_A_NUMBER, WatchdogLevel::outputs).size(), 1u);
}

TEST_F(WatchdogTest, LevelOffSeesNothing) {
  EXPECT_TRUE(watch(BROKEN_NOT_A_NUMBER, WatchdogLevel::off).empty());
  EXPECT_TRUE(watch(BROKEN_SLOW, WatchdogLevel::off).empty());
}

TEST_F(WatchdogTest, CountsExactlyTheRaysAtFault) {
  const std::vector<float> values = {0.1f, 0.1f, 0.1f, 0.5f,  NAN,   0, 0, 0.5f,  0.9f, 0, 0, 0.5f,
                                     0,    0,    0,    -0.5f, -0.1f, 0, 0, 0.25f, 0,    0, 0, INFINITY};
  const std::vector<float> depths = {1.0f, 1.0f, 1.0f, 1.0f, -INFINITY, INFINITY};
  const gpu::Buffer colours(device(), "colours", values.size() * 4, gpu::Memory::upload);
  const gpu::Buffer depths_m(device(), "depths", depths.size() * 4, gpu::Memory::upload);
  gpu::upload_values(device(), colours, std::span<const float>(values));
  gpu::upload_values(device(), depths_m, std::span<const float>(depths));
  Watchdog watchdog(device(), WatchdogLevel::outputs, kernels);
  gpu::CommandList commands(device(), "check");
  watchdog.record_output_check(commands, colours, depths_m, 6);
  (void)gpu::submit_and_wait(commands);
  watchdog.collect_outputs("cast/x", 3);
  ASSERT_EQ(watchdog.reports().size(), 3u);
  EXPECT_EQ(watchdog.reports()[0].clause, "NaN or Inf in a result");
  EXPECT_EQ(watchdog.reports()[0].count, 3u);  // NaN, -Inf as depth, Inf as opacity
  EXPECT_EQ(watchdog.reports()[1].clause, "colour outside [0, opacity]");
  EXPECT_EQ(watchdog.reports()[1].count, 2u);  // over opacity; under an opacity below zero
  EXPECT_EQ(watchdog.reports()[2].clause, "opacity outside [0, 1]");
  EXPECT_EQ(watchdog.reports()[2].count, 1u);
  watchdog.collect_outputs("cast/x", 4);
  EXPECT_EQ(watchdog.reports()[0].count, 3u);  // taken once
}

TEST_F(WatchdogTest, LostDeviceNamesTheStageAndIsCounted) {
  Watchdog watchdog(device(), WatchdogLevel::outputs, kernels);
  try {
    watchdog.attribute_loss("cast/mip", 12, [] { throw gpu::DeviceLost("llvmpipe: device lost"); });
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::device_or_plugin_failed);
    EXPECT_THAT(error.what(), testing::HasSubstr("in stage cast/mip, eye frame 12"));
  }
  ASSERT_EQ(watchdog.reports().size(), 1u);
  EXPECT_EQ(watchdog.reports()[0].clause, "device lost");
}

TEST(WatchdogLevelText, NamesAreCheckedWithTheNearest) {
  EXPECT_EQ(parse_watchdog_level("full"), WatchdogLevel::full);
  try {
    (void)parse_watchdog_level("outpust");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean 'outputs'"));
  }
}

}  // namespace
}  // namespace brace
