#include "runtime/host/stage_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "temporary_folder.hpp"

namespace brace {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

template <typename Call>
std::string input_error_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

StageInfo stage(const char* family, const char* name, const char* origin = "") {
  StageInfo info;
  info.family = family;
  info.name = name;
  info.origin = origin;
  return info;
}

TEST(StageRegistry, UnknownStageNamesThePlaceTheNearestAndAll) {
  StageRegistry registry;
  registry.add(stage("cast", "dvr"));
  registry.add(stage("cast", "mip"));
  EXPECT_THAT(input_error_of([&] { (void)registry.find("cast", "dvrr", "demo.toml:7"); }),
              AllOf(HasSubstr("demo.toml:7"), HasSubstr("'cast/dvrr'"), HasSubstr("did you mean 'dvr'"),
                    HasSubstr("dvr, mip")));
  EXPECT_THAT(input_error_of([&] { (void)registry.find("warp", "quad", "demo.toml:8"); }),
              HasSubstr("none of this family"));
}

TEST(StageRegistry, SameNameInAnotherFamilyIsAnotherStage) {
  StageRegistry registry;
  registry.add(stage("warp", "none"));
  registry.add(stage("skip", "none"));
  EXPECT_EQ(registry.find("skip", "none", "").family, "skip");
}

TEST(StageRegistry, ConflictNamesBothOrigins) {
  StageRegistry registry;
  registry.add(stage("cast", "mip", "a/stage.toml"));
  EXPECT_THAT(input_error_of([&] { registry.add(stage("cast", "mip", "b/stage.toml")); }),
              AllOf(HasSubstr("cast/mip"), HasSubstr("a/stage.toml"), HasSubstr("b/stage.toml")));
  registry.add(stage("cast", "dvr"));
  EXPECT_THAT(input_error_of([&] { registry.add(stage("cast", "dvr", "b.toml")); }), HasSubstr("built in"));
}

TEST(StageRegistry, FolderIsReadInSortedOrder) {
  const TemporaryFolder folder;
  for (const char* name : {"zebra", "ant", "mole"}) {
    folder.write(std::string("skip/") + name + "/stage.toml",
                 std::string("[stage]\nkind='skip'\nname='") + name + "'\nversion='1'\nhelp='h'\n");
  }
  StageRegistry registry;
  registry.add_folder(folder.path());
  EXPECT_THAT(registry.names("skip"), ::testing::ElementsAre("ant", "mole", "zebra"));
}

TEST(StageRegistry, ParameterValuesAreCheckedAgainstRangeTypeAndUnit) {
  const StageInfo info = stage("cast", "dvr");
  StageParameter step;
  step.name = "step_voxels";
  step.unit = "voxels";
  step.minimum = 0.01;
  step.maximum = 64.0;
  check_parameter_value(info, step, 0.01, "here");
  check_parameter_value(info, step, 64.0, "here");
  for (const double bad : {0.0, 65.0, std::numeric_limits<double>::quiet_NaN(), -1.0}) {
    EXPECT_THAT(input_error_of([&] { check_parameter_value(info, step, bad, "demo.toml:9"); }),
                AllOf(HasSubstr("demo.toml:9"), HasSubstr("step_voxels"), HasSubstr("0.01 to 64 voxels")));
  }
  step.type = ParameterType::integer;
  EXPECT_THAT(input_error_of([&] { check_parameter_value(info, step, 1.5, "x"); }),
              HasSubstr("whole numbers"));
}

TEST(StageRegistry, DescriptorBecomesTheSameDescriptionAsAManifest) {
  static const char* const choices[] = {"left", "right", nullptr};
  const brace_param params[] = {
      {sizeof(brace_param), "rate_hz", BRACE_PARAM_INT, "Hz", "how often", 1, 9, 3, nullptr},
      {sizeof(brace_param), "side", BRACE_PARAM_CHOICE, "", "which", 0, 0, 1, choices}};
  brace_stage_descriptor descriptor{};
  descriptor.struct_size = sizeof descriptor;
  descriptor.kind = BRACE_KIND_COST;
  descriptor.name = "flat";
  descriptor.version = "2.0.0";
  descriptor.help = "same for all";
  descriptor.params = params;
  descriptor.param_count = 2;
  StageRegistry registry;
  registry.add(descriptor, "flat.so");
  const StageInfo& info = registry.find("cost", "flat", "");
  EXPECT_EQ(info.version, "2.0.0");
  EXPECT_EQ(info.native, &descriptor);
  EXPECT_EQ(info.parameters[0].unit, "Hz");
  EXPECT_EQ(info.parameters[1].choices, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(info.parameters[1].maximum, 1.0);
}

TEST(StageRegistry, EveryKindHasItsFamily) {
  for (int kind = BRACE_KIND_RAYS; kind <= BRACE_KIND_COST; ++kind) {
    brace_stage_descriptor descriptor{};
    descriptor.kind = static_cast<std::uint32_t>(kind);
    descriptor.name = "x";
    EXPECT_EQ(stage_info(descriptor, "").family, stage_families()[static_cast<std::size_t>(kind - 1)]);
  }
  EXPECT_EQ(stage_families()[BRACE_KIND_RAYS - 1], "rays");
  EXPECT_EQ(stage_families()[BRACE_KIND_CAST - 1], "cast");
  EXPECT_EQ(stage_families()[BRACE_KIND_WARP - 1], "warp");
  EXPECT_EQ(stage_families()[BRACE_KIND_COST - 1], "cost");
}

}  // namespace
}  // namespace brace
