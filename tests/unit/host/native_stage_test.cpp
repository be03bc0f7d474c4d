#include "runtime/host/native_stage.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "plugins/examples/broken/broken_stages.h"
#include "runtime/host/plugin_library.hpp"
#include "runtime/host/stage_activation.hpp"
#include "runtime/volume/generators.hpp"

namespace brace {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

PipelineStage stage_of(const std::filesystem::path& file, const char* family, const char* name) {
  StageRegistry registry;
  add_plugins(registry, {.given = {file}, .ambient = {}, .installed = {}});
  PipelineStage stage;
  stage.stage = registry.find(family, name, "test");
  for (const StageParameter& parameter : stage.stage.parameters)
    stage.values.push_back(parameter.default_value);
  return stage;
}

const std::filesystem::path alpha_beta = std::filesystem::path(EXAMPLE_PLUGINS) / "alpha_beta.so";
const std::filesystem::path aimd = std::filesystem::path(EXAMPLE_PLUGINS) / "aimd_control.so";
const std::filesystem::path broken_library = std::filesystem::path(BROKEN_PLUGINS) / "broken_stages.so";

PipelineStage broken_stage(const char* family, broken_defect defect) {
  PipelineStage stage = stage_of(broken_library, family, "broken");
  stage.values[0] = defect;
  return stage;
}

template <typename Call>
std::string plugin_error(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::device_or_plugin_failed);
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

brace_tracker_sample turning(std::int64_t time_ns, double rad_s, double m_s) {
  const double t = static_cast<double>(time_ns) * 1e-9;
  brace_tracker_sample sample{};
  sample.time_ns = time_ns;
  sample.world_from_head = to_abi({quat_exp({0.0, rad_s * t, 0.0}), {m_s * t, 1.6, 0.0}});
  sample.angular_velocity_rad_s[1] = rad_s;
  sample.linear_velocity_m_s[0] = m_s;
  return sample;
}

TEST(NativeStage, AlphaBetaFollowsASteadyTurnExactly) {
  NativeStage stage(stage_of(alpha_beta, "predict", "alpha_beta"));
  stage.activate();
  std::vector<brace_tracker_sample> history;
  for (int i = 0; i < 40; ++i)
    history.push_back(turning(i * 1'000'000, 3.0, 0.7));
  brace_pose pose{};
  ASSERT_EQ(stage.predict_functions().predict(stage.self(), history.data(), 40, 60'000'000, &pose), BRACE_OK);
  const Pose expected = from_abi(turning(60'000'000, 3.0, 0.7).world_from_head);
  EXPECT_LT(angle_between_rad(from_abi(pose).orientation, expected.orientation), 1e-9);
  EXPECT_NEAR(pose.position_m[0], expected.position.x, 1e-12);
}

TEST(NativeStage, AlphaBetaStartsAnewWithEveryActivation) {
  NativeStage stage(stage_of(alpha_beta, "predict", "alpha_beta"));
  const auto ask = [&](double rate) {
    const brace_tracker_sample sample = turning(5'000'000, rate, 0.0);
    brace_pose pose{};
    EXPECT_EQ(stage.predict_functions().predict(stage.self(), &sample, 1, 6'000'000, &pose), BRACE_OK);
    return pose.orientation_xyzw[1];
  };
  stage.activate();
  const double first = ask(1.0);
  EXPECT_EQ(ask(9.0), first);  // not newer than what it has: no news
  stage.deactivate();
  stage.activate();
  EXPECT_GT(ask(9.0), first);
}

TEST(NativeStage, AimdCutsOnOverloadAndRecovers) {
  NativeStage stage(stage_of(aimd, "control", "aimd"));
  stage.activate();
  double quality = 1.0;
  const auto frame = [&](std::int64_t cost_ns, std::uint32_t missed) {
    const brace_control_input input{sizeof input, 0, cost_ns, 11'111'111, missed, 0};
    EXPECT_EQ(stage.control_functions().update(stage.self(), &input, &quality), BRACE_OK);
    return quality;
  };
  EXPECT_EQ(frame(1'000'000, 0), 1.0);
  EXPECT_NEAR(frame(2 * 11'111'111, 1), 0.5, 1e-12);     // never more than half at once
  EXPECT_NEAR(frame(11'111'111, 0), 0.5 * 0.85, 1e-12);  // to what would have met the target
  for (int i = 0; i < 200; ++i)
    frame(1'000'000, 0);
  EXPECT_EQ(quality, 1.0);
  for (int i = 0; i < 200; ++i)
    frame(500'000'000, 3);
  EXPECT_EQ(quality, 0.05);  // its floor
}

TEST(NativeStage, FailedCreateNamesStageFileAndCall) {
  const PipelineStage stage = broken_stage("predict", BROKEN_CREATE_FAILS);
  EXPECT_THAT(plugin_error([&] { NativeStage object(stage); }),
              AllOf(HasSubstr("broken_stages.so"), HasSubstr("predict/broken"), HasSubstr("create"),
                    HasSubstr("found null")));
}

TEST(NativeStage, FailedActivationQuotesTheStagesOwnWords) {
  NativeStage stage(broken_stage("control", BROKEN_ACTIVATE_FAILS));
  EXPECT_THAT(plugin_error([&] { stage.activate(); }),
              AllOf(HasSubstr("activate"), HasSubstr("BRACE_UNSUPPORTED"),
                    HasSubstr("this stage does not activate")));
  EXPECT_FALSE(stage.is_active());
}

TEST(NativeStage, FailedFrameQuotesTheStagesOwnWords) {
  NativeStage stage(broken_stage("cast", BROKEN_RECORD_FAILS));
  stage.activate();
  const brace_cast_frame frame{};
  EXPECT_THAT(plugin_error([&] { stage.cast(frame); }),
              AllOf(HasSubstr("cast/broken"), HasSubstr("execute"), HasSubstr("fails in every frame")));
}

TEST(NativeStage, ExceptionAcrossTheInterfaceIsAPluginError) {
  brace_stage_descriptor descriptor{};
  descriptor.struct_size = sizeof descriptor;
  descriptor.kind = BRACE_KIND_CONTROL;
  descriptor.name = "throws";
  descriptor.version = "1.0.0";
  descriptor.help = "throws";
  descriptor.create = [](const double*, std::uint32_t) -> void* { throw std::runtime_error("no"); };
  descriptor.destroy = [](void*) {};
  PipelineStage stage;
  stage.stage = stage_info(descriptor, "throws.so");
  EXPECT_THAT(plugin_error([&] { NativeStage object(stage); }), HasSubstr("an exception thrown across"));
}

TEST(NativeStage, DestroysOnceAndDeactivatesFirst) {
  static std::string calls;
  calls.clear();
  brace_stage_descriptor descriptor{};
  descriptor.struct_size = sizeof descriptor;
  descriptor.kind = BRACE_KIND_CONTROL;
  descriptor.name = "counts";
  descriptor.version = "1.0.0";
  descriptor.help = "counts";
  descriptor.create = [](const double*, std::uint32_t) -> void* { return &calls; };
  descriptor.destroy = [](void*) { calls += "destroy "; };
  descriptor.activate = [](void*, const brace_activation*) {
    calls += "activate ";
    return BRACE_OK;
  };
  descriptor.deactivate = [](void*) { calls += "deactivate "; };
  PipelineStage stage;
  stage.stage = stage_info(descriptor, "");
  {
    NativeStage first(stage);
    first.activate();
    NativeStage second = std::move(first);
    EXPECT_FALSE(first);  // NOLINT(bugprone-use-after-move): moved-from is empty, which is what is tested
    EXPECT_TRUE(second.is_active());
  }
  EXPECT_EQ(calls, "activate deactivate destroy ");
}

TEST(StageActivation, VoxelSlicesComeInAnyOrderAndBadOnesAreRefused) {
  const std::string name = "generator:marschner_lobb:9x7x5";
  const Volume volume = load_volume(*open_volume(name));
  int opened = 0;
  ActivationInput input;
  input.volume = &volume.info;
  input.open_volume = [&] {
    ++opened;
    return open_volume(name);
  };
  const StageActivation activation(input);
  const brace_volume& seen = *activation.get().volume;
  EXPECT_EQ(seen.dims[0], 9u);
  EXPECT_EQ(seen.dims[2], 5u);
  const std::size_t slice = volume.info.slice_bytes();
  std::vector<std::byte> got(2 * slice);
  for (const std::uint32_t z : {0u, 2u, 3u, 0u}) {  // on, on, back (twice)
    ASSERT_EQ(seen.read_slices(&seen, z, 2, got.data(), got.size()), BRACE_OK) << z;
    EXPECT_TRUE(
        std::equal(got.begin(), got.end(), volume.voxels.begin() + static_cast<std::ptrdiff_t>(z * slice)));
  }
  EXPECT_EQ(opened, 3);
  EXPECT_EQ(seen.read_slices(&seen, 4, 2, got.data(), got.size()), BRACE_INVALID_ARGUMENT);
  EXPECT_EQ(seen.read_slices(&seen, 5, 1, got.data(), slice), BRACE_INVALID_ARGUMENT);
  EXPECT_EQ(seen.read_slices(&seen, 0, 1, got.data(), slice - 1), BRACE_INVALID_ARGUMENT);
  EXPECT_EQ(seen.read_slices(&seen, 0, 0, got.data(), 0), BRACE_INVALID_ARGUMENT);
}

TEST(StageActivation, ReadErrorKeepsTheReadersOwnMessage) {
  VolumeInfo info;
  info.dims = {2, 2, 2};
  ActivationInput input;
  input.volume = &info;
  input.open_volume = []() -> std::unique_ptr<VolumeSource> { throw input_error("brain.nrrd: cut short"); };
  const StageActivation activation(input);
  const brace_volume& seen = *activation.get().volume;
  char bytes[4];
  EXPECT_EQ(seen.read_slices(&seen, 0, 1, bytes, 4), BRACE_ERROR);
  EXPECT_THROW(activation.rethrow_read_error(), Error);
}

}  // namespace
}  // namespace brace
