#include "runtime/sweep/sweep_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> texts_of(const SweepPoint& point) {
  std::vector<std::string> texts;
  for (const SweepSetting& setting : point.settings)
    texts.push_back(setting.key + "=" + setting.toml_text);
  return texts;
}

std::string error_of(const std::string& text) {
  try {
    (void)parse_sweep(text, "sweep.toml");
  } catch (const Error& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
    return e.what();
  }
  return "no error";
}

TEST(SweepFileTest, AGridHasEveryCombinationInTheFilesOrder) {
  const SweepFile sweep = parse_sweep(R"(session = "s.toml"
repeat = 3
[set]
run.frames = 10
[grid]
pipeline.warp = ["quad", "none"]
"stage.dvr.step_voxels" = [0.5, 1]
)",
                                      "some/sweep.toml");
  EXPECT_EQ(sweep.repeat, 3);
  EXPECT_EQ(sweep.session.filename(), "s.toml");
  EXPECT_EQ(sweep.session.parent_path().filename(), "some");
  EXPECT_THAT(sweep.keys, ElementsAre("pipeline.warp", "stage.dvr.step_voxels"));
  ASSERT_EQ(sweep.points.size(), 4u);
  EXPECT_THAT(texts_of(sweep.points[1]),
              ElementsAre("run.frames=10", HasSubstr("quad"), "stage.dvr.step_voxels=1"));
  EXPECT_THAT(texts_of(sweep.points[2]), ElementsAre("run.frames=10", HasSubstr("none"), HasSubstr("0.5")));
}

TEST(SweepFileTest, EveryEntryOfTheListMeetsEveryPointOfTheGrid) {
  const SweepFile sweep = parse_sweep(R"(session = "s.toml"
[grid]
run.seed = [1, 2, 3]
[[point]]
pipeline.skip = "none"
[[point]]
pipeline.skip = "block"
stage.block.edge = 8
)",
                                      "sweep.toml");
  ASSERT_EQ(sweep.points.size(), 6u);
  EXPECT_THAT(sweep.keys, ElementsAre("run.seed", "pipeline.skip", "stage.block.edge"));
  EXPECT_EQ(sweep.points[5].settings.size(), 3u);
  EXPECT_THAT(sweep.points[5].place, HasSubstr("point 6"));
}

TEST(SweepFileTest, ATableIsAValueInBracesAndKeysOtherwise) {
  const SweepFile sweep = parse_sweep(R"(session = "s.toml"
[[point]]
trace.neck = { motion = "still", seconds = 2 }
[[point]]
trace.neck.motion = "still"
)",
                                      "sweep.toml");
  EXPECT_THAT(texts_of(sweep.points[0]), ElementsAre(testing::MatchesRegex("trace.neck=[{].*still.*2.*[}]")));
  EXPECT_THAT(texts_of(sweep.points[1]), ElementsAre("trace.neck.motion='still'"));
}

TEST(SweepFileTest, WhatIsWrongIsNamedWithItsPlace) {
  EXPECT_THAT(error_of("[grid]\nrun.seed = [1]\n"), HasSubstr("'session' is missing"));
  EXPECT_THAT(error_of("session = \"s.toml\"\n"), HasSubstr("nothing to vary"));
  EXPECT_THAT(error_of("session = \"s.toml\"\ngird = 1\n"), HasSubstr("gird"));
  EXPECT_THAT(error_of("session = \"s.toml\"\n[grid]\nrun.seed = 1\n"),
              testing::AllOf(HasSubstr("sweep.toml:3"), HasSubstr("list of values")));
  EXPECT_THAT(error_of("session = \"s.toml\"\nrepeat = 0\n[grid]\nrun.seed = [1]\n"),
              HasSubstr("1 to 10000"));
  EXPECT_THAT(error_of("session = \"s.toml\"\n[grid]\nseed = [1]\n"), HasSubstr("no session key"));
  EXPECT_THAT(error_of("session = \"s.toml\"\n[grid]\nrun.seed = [1]\n[[point]]\nrun.seed = 2\n"),
              HasSubstr("in [grid] and in [[point]]"));
  EXPECT_THAT(error_of("session = \"s.toml\"\n[grid]\nrun.seed = [\n"), HasSubstr("sweep.toml"));
  std::string many = "session = \"s.toml\"\n[grid]\n";
  for (const char* key : {"run.seed", "run.frames", "scene.size_m"}) {
    many += std::string(key) + " = [0";
    for (int i = 1; i < 500; ++i)
      many.append(",").append(std::to_string(i));
    many += "]\n";
  }
  EXPECT_THAT(error_of(many), HasSubstr("more than"));
}

}  // namespace
}  // namespace brace
