// The shipped extreme scenes run with stages of every family, at a tiny size: done, or refused as bad input.
#include <map>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;

const std::filesystem::path examples = std::filesystem::path(BRACE_SOURCE_DIR) / "examples/extreme";

std::vector<std::string> scenes() {
  return {"stiff_shell", "delta_tf",   "fog_1e12", "one_voxel",
          "all_empty",   "all_opaque", "needle",   "huge_gradient"};
}

/// Settings of cast/dvr beside its defaults.
const std::vector<std::vector<std::string>> cast_settings = {
    {},
    {"stage.dvr.integrator=left"},
    {"stage.dvr.integrator=linear-source"},
    {"stage.dvr.integrator=pre-integrated"},
    {"stage.dvr.integrator=pre-integrated", "stage.dvr.preintegration=integral"},
    {"stage.dvr.tolerance=0.001"},
    {"stage.dvr.tolerance=0.001", "stage.dvr.integrator=pre-integrated"}};

TEST(Extremes, RunThroughTheStagesOfEveryFamily) {
  const Workplace place;
  const auto listed = nlohmann::json::parse(place.brace({"list", "stages", "--json"}).out);
  std::map<std::string, std::vector<std::string>> families;
  for (const auto& stage : listed) {
    const std::string id = stage["name"];
    const std::string family = id.substr(0, id.find('/'));
    // `cost` stages are chosen by clock.cost; casts other than ours have tests of their own.
    if (family != "cost" && family != "cast") families[family].push_back(id.substr(id.find('/') + 1));
  }
  ASSERT_GE(families.size(), 5u);
  std::size_t index = 0, done = 0;
  for (const std::string& scene : scenes()) {
    std::vector<std::string> arguments = {"run",      (examples / (scene + ".toml")).string(),
                                          "--set",    "device.resolution_scale=0.02",
                                          "--set",    "output.images=none",
                                          "--frames", "3",
                                          "--out",    scene,
                                          "--json"};
    for (const auto& [family, names] : families) {
      arguments.push_back("--set");
      arguments.push_back("pipeline." + family + "=" + names[index % names.size()]);
    }
    for (const std::string& setting : cast_settings[index % cast_settings.size()]) {
      arguments.push_back("--set");
      arguments.push_back(setting);
    }
    Outcome outcome = place.brace(arguments);
    ++index;
    // A combination may be refused, with a message; it may not fail.
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 2) << scene << ": " << outcome.err;
    if (outcome.exit_code != 0) {
      EXPECT_THAT(outcome.err, testing::HasSubstr("brace: ")) << scene;
      // Again without the stages that share least with others.
      for (const char* plain : {"pipeline.stereo=two_pass", "pipeline.schedule=whole_frame"}) {
        arguments.push_back("--set");
        arguments.push_back(plain);
      }
      outcome = place.brace(arguments);
    }
    if (outcome.exit_code != 0) continue;
    ++done;
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary["vsyncs"], 3) << scene;
    if (summary["dssim"]["max"].is_number()) {
      EXPECT_LE(summary["dssim"]["max"].get<double>(), 1.0) << scene;
    }
  }
  EXPECT_GE(done, 6u) << "most combinations must be accepted";
}

TEST(Extremes, AToleranceIsRefusedWhereNothingCanKeepIt) {
  const Workplace place;
  const auto run = [&](const std::vector<std::string>& settings) {
    std::vector<std::string> arguments = {
        "run", (examples / "one_voxel.toml").string(), "--frames", "2", "--out", "refused"};
    for (const std::string& setting : settings) {
      arguments.push_back("--set");
      arguments.push_back(setting);
    }
    return place.brace(arguments);
  };
  const Outcome left = run({"stage.dvr.tolerance=0.001", "stage.dvr.integrator=left"});
  EXPECT_EQ(left.exit_code, 2);
  EXPECT_THAT(left.err, testing::HasSubstr("no error estimate"));
  const Outcome steps = run({"stage.dvr.tolerance=0.001", "stage.dvr.step_voxels_min=2"});
  EXPECT_EQ(steps.exit_code, 2);
  EXPECT_THAT(steps.err, testing::HasSubstr("step_voxels_min = 2"));
  EXPECT_FALSE(std::filesystem::exists(place / "refused"));
}

TEST(Verify, CommandListsClaimsAndRefusesUnknownGroups) {
  const Workplace place;
  const Outcome lenses = place.brace({"verify", "lenses", "--json", "--out", "page"});
  EXPECT_EQ(lenses.exit_code, 0) << lenses.out << lenses.err;
  const auto json = nlohmann::json::parse(lenses.out);
  EXPECT_TRUE(json["passed"].get<bool>());
  EXPECT_GE(json["claims"].size(), 5u);
  EXPECT_THAT(place.read("page/report.html"), testing::HasSubstr("Numerical verification"));
  const Outcome unknown = place.brace({"verify", "lense"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, testing::HasSubstr("did you mean 'lenses'"));
}

}  // namespace
}  // namespace brace
