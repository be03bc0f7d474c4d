// `brace plan` and `brace run --plan`: what scenes that need little and scenes that need much keep.
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// Everything on, at a tiny size.
const std::string everything = R"(
[device]
profile = "htc-vive"
resolution_scale = 0.04
[trace]
neck = { motion = "spin", degrees = 90, seconds = 2 }
[scene]
volume = "generator:solid_box:24"
transfer_function = "mri-brain"
shading = "phong"
size_m = 0.5
position = "front:0.8"
[pipeline]
skip = "distance_map"
warp = "grid"
[stage.dvr]
integrator = "pre-integrated"
[output]
images = "none"
error = "none"
[run]
frames = 8
)";

class CliPlan : public testing::Test {
 protected:
  void SetUp() override { place_.write("s.toml", everything); }
  Outcome plan(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"plan", "s.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return place_.brace(arguments);
  }
  /// item -> verdict
  std::map<std::string, std::string> verdicts(std::vector<std::string> more) const {
    more.push_back("--json");
    const Outcome outcome = plan(more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    std::map<std::string, std::string> found;
    if (outcome.exit_code != 0) return found;
    const auto json = nlohmann::json::parse(outcome.out);
    for (const auto& item : json["items"])
      found[item["item"]] = item["verdict"];
    return found;
  }
  Workplace place_;
};

TEST_F(CliPlan, AHomogeneousBoxBeforeAStillHeadNeedsHardlyAnything) {
  auto found = verdicts({"--set", "scene.volume=generator:slab:24", "--set", "trace.neck.motion=still",
                         "--set", "device.tracker=ideal"});
  EXPECT_EQ(found["shading"], "left out") << "there is no gradient";
  EXPECT_EQ(found["preintegration"], "left out");
  EXPECT_EQ(found["skip"], "left out") << "nothing to skip";
  EXPECT_EQ(found["warp"], "left out") << "nothing moves";
  EXPECT_EQ(found["early_termination"], "kept") << "it is opaque";
  EXPECT_EQ(found["stereo"], "absent");
  EXPECT_EQ(found["chromatic_channels"], "kept");
}

TEST_F(CliPlan, ATurningHeadKeepsItsWarpAndEmptySpaceItsMap) {
  auto found = verdicts({"--set", "scene.transfer_function=ct-bone"});
  EXPECT_EQ(found["warp"], "kept");
  EXPECT_EQ(found["skip"], "kept");
}

TEST_F(CliPlan, LevelsOfTheAtlasGoOneByOne) {
  // The volume is seen in the middle alone: outer levels have nothing to show there.
  const std::vector<std::string> small = {"--set", "pipeline.rays=mab",  "--set",       "scene.size_m=0.1",
                                          "--set", "stage.mab.levels=3", "--leave-out", "shading"};
  auto found = verdicts(small);
  EXPECT_EQ(found["mab_level_0"], "kept") << "what is seen";
  EXPECT_EQ(found["mab_level_2"], "left out");
  EXPECT_FALSE(found.contains("mab_level_3"));
  // Nothing to see at all: the picture stands any level's going, but for the last.
  std::vector<std::string> nothing = small;
  nothing.insert(nothing.end(), {"--set", "scene.transfer_function=" BRACE_SOURCE_DIR
                                          "/examples/extreme/all_empty.tf.toml"});
  found = verdicts(nothing);
  int left_out = 0;
  for (const char* level : {"mab_level_0", "mab_level_1", "mab_level_2"})
    left_out += found[level] == "left out";
  EXPECT_EQ(found["rays"] == "left out" ? 2 : left_out, 2);
}

TEST_F(CliPlan, TellsWhatTheSceneIsLike) {
  std::vector<std::string> quick = {"--json"};  // nothing to try
  for (const char* item : {"shading", "preintegration", "early_termination", "skip", "warp"}) {
    quick.push_back("--leave-out");
    quick.push_back(item);
  }
  const auto facts_with = [&](const std::string& volume) {
    std::vector<std::string> arguments = quick;
    arguments.insert(arguments.end(), {"--set", "scene.volume=generator:" + volume});
    const Outcome outcome = plan(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["facts"];
  };
  const auto slab = facts_with("slab:24");
  EXPECT_EQ(slab["volume"]["occupancy"], 1.0) << "it is the same everywhere";
  EXPECT_EQ(slab["volume"]["kappa_dt_max"], slab["volume"]["kappa_dt_min"]);
  const auto box = facts_with("solid_box:24");
  EXPECT_LT(box["volume"]["occupancy"], 1.0);
  EXPECT_GT(box["volume"]["kappa_dt_max"], box["volume"]["kappa_dt_min"]);
  EXPECT_GT(box["disparity_px"].get<double>(), 0.1);
  EXPECT_EQ(box["lens"]["kind"], "vive");
  EXPECT_EQ(box["scan_out"]["direction"], "top_to_bottom");
}

TEST_F(CliPlan, WhatIsAskedForIsKeptOrLeftOut) {
  auto found = verdicts({"--set", "trace.neck.motion=still", "--keep", "warp", "--leave-out", "shading"});
  EXPECT_EQ(found["warp"], "kept");
  EXPECT_EQ(found["shading"], "left out");
}

TEST_F(CliPlan, WithoutALensDistortionIsIdleUnlessKept) {
  // Nothing else to try.
  std::vector<std::string> plain = {"--set", "device.lens=none"};
  for (const char* item : {"shading", "preintegration", "early_termination", "skip", "warp"}) {
    plain.push_back("--leave-out");
    plain.push_back(item);
  }
  EXPECT_EQ(verdicts(plain)["distortion"], "idle");
  plain.insert(plain.end(), {"--keep", "distortion"});
  EXPECT_EQ(verdicts(plain)["distortion"], "kept");
}

TEST_F(CliPlan, TheCheckTellsBothWaysInOneReport) {
  const Outcome outcome = plan({"--set", "scene.volume=generator:slab:24", "--set", "output.error=ends",
                                "--check", "--out", "both", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(json["check"]["passed"].get<bool>());
  EXPECT_LT(json["check"]["planned_ms"], json["check"]["given_ms"]);
  const auto summary = nlohmann::json::parse(place_.read("both/summary.json"));
  EXPECT_EQ(summary["series"][1]["label"], "planned");
  EXPECT_THAT(summary["series"][1]["left_out"].dump(), HasSubstr("not needed here"));
}

TEST_F(CliPlan, ARunThatPlansLeavesTheSameOut) {
  const Outcome planned = place_.brace(
      {"run", "s.toml", "--plan", "--set", "scene.volume=generator:slab:24", "--out", "planned", "--json"});
  ASSERT_EQ(planned.exit_code, 0) << planned.err;
  EXPECT_THAT(planned.err, HasSubstr("leaves out"));
  const auto summary = nlohmann::json::parse(planned.out);
  EXPECT_EQ(summary["pipeline"]["skip"], "skip/none");
  EXPECT_THAT(place_.read("planned/session.toml"), HasSubstr("skip"));
  const Outcome named =
      place_.brace({"run", "s.toml", "--leave-out", "skip", "--leave-out", "shading", "--leave-out",
                    "preintegration", "--set", "scene.volume=generator:slab:24", "--json"});
  ASSERT_EQ(named.exit_code, 0) << named.err;
  EXPECT_EQ(nlohmann::json::parse(named.out)["gpu_ms"], summary["gpu_ms"]);
}

TEST_F(CliPlan, WhatCannotBeLeftOutIsRefused) {
  const Outcome lens = place_.brace({"run", "s.toml", "--leave-out", "distortion"});
  EXPECT_EQ(lens.exit_code, 2);
  EXPECT_THAT(lens.err, HasSubstr("another headset"));
  const Outcome typo = plan({"--leave-out", "wrap"});
  EXPECT_EQ(typo.exit_code, 2);
  EXPECT_THAT(typo.err, HasSubstr("did you mean 'warp'?"));
  place_.write("c.toml", everything + "[compare]\nkey = 'pipeline.warp'\nvalues = ['none', 'quad']\n");
  const Outcome several = place_.brace({"plan", "c.toml"});
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_THAT(several.err, HasSubstr("[compare]"));
}

TEST_F(CliPlan, ConvergedIdealsAreMadeByTheirOwnCasterAlone) {
  EXPECT_EQ(place_.brace({"run", "s.toml", "--set", "output.error=ends", "--set", "output.ideal=converged"})
                .exit_code,
            0);
  const Outcome mip = place_.brace({"run", "s.toml", "--set", "output.error=ends", "--set",
                                    "output.ideal=converged", "--set", "pipeline.cast=native"});
  EXPECT_EQ(mip.exit_code, 2);
  EXPECT_THAT(mip.err, HasSubstr("cast/dvr"));
}

}  // namespace
}  // namespace brace
