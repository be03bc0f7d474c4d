// Native stages of every kind in a run, the watchdog's eye on them, and what is left of a run that one of
// them ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "plugins/examples/broken/broken_stages.h"
#include "tests/cli/command.hpp"

namespace brace {
namespace {

using nlohmann::json;
using test::Outcome;
using test::Workplace;
using testing::AllOf;
using testing::HasSubstr;

const std::string session = R"([device]
profile = "htc-vive"
resolution_scale = 0.02
[trace]
neck = { motion = "rotation", seconds = 0.3 }
[scene]
volume = "generator:solid_box:16"
transfer_function = "tf1"
[output]
images = "none"
error = "every:1"
[run]
frames = 6
)";

class CliStages : public testing::Test {
 protected:
  /// One stage of the broken library in its place of the pipeline.
  Outcome run(const std::string& kind, int defect, const std::vector<std::string>& more = {}) {
    place_.write("s.toml", session);
    const std::string choice = kind == "cost" ? "clock.cost=stage:broken" : "pipeline." + kind + "=broken";
    std::vector<std::string> arguments = {
        "run",         "s.toml", "--out", "out",   "--plugin-path",
        BROKEN_STAGES, "--set",  choice,  "--set", "stage.broken.defect=" + std::to_string(defect)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return place_.brace(arguments);
  }
  json summary() const { return json::parse(place_.read("out/summary.json")); }

  Workplace place_;
};

TEST_F(CliStages, EveryNativeKindRuns) {
  for (const char* kind : {"rays", "cast", "skip", "stereo", "warp", "control", "predict", "cost"}) {
    const Outcome outcome = run(kind, BROKEN_NONE, {"--watchdog", "full"});
    ASSERT_EQ(outcome.exit_code, 0) << kind << outcome.err;
    const json summary = this->summary();
    EXPECT_EQ(summary["complete"], true) << kind;
    EXPECT_EQ(summary["pipeline"][kind], std::string(kind) + "/broken");
    EXPECT_EQ(summary["watchdog_level"], "full");
    EXPECT_EQ(summary["vsyncs"], 6);
  }
}

TEST_F(CliStages, AStageThatFailsLeavesTheRunIncomplete) {
  for (const char* kind : {"rays", "cast", "stereo", "warp", "control", "predict", "cost"}) {
    const Outcome outcome = run(kind, BROKEN_RECORD_FAILS);
    EXPECT_EQ(outcome.exit_code, 3) << kind;
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr(BROKEN_STAGES), HasSubstr(std::string(kind) + "/broken"),
                      HasSubstr("expected BRACE_OK"), HasSubstr("found"), HasSubstr("incomplete")))
        << kind;
    const json summary = this->summary();
    EXPECT_EQ(summary["complete"], false) << kind;
    EXPECT_THAT(summary["failure"].get<std::string>(), HasSubstr(std::string(kind) + "/broken"));
    EXPECT_THAT(place_.read("out/report.html"),
                AllOf(HasSubstr("\"failure\":"), testing::Not(HasSubstr("the number of vsyncs asked for"))));
    EXPECT_THAT(place_.read("out/frames.csv"), HasSubstr("\n0,"));
  }
}

TEST_F(CliStages, AStageThatFailsBeforeTheFirstVsyncLeavesNothing) {
  const Outcome outcome = run("skip", BROKEN_RECORD_FAILS);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("skip/broken"), HasSubstr("expected BRACE_OK"),
                                 HasSubstr("found BRACE_ERROR")));
  EXPECT_THAT(place_.names(), testing::ElementsAre("s.toml"));
}

TEST_F(CliStages, TheWatchdogNamesStageAndFault) {
  const std::pair<int, const char*> faults[] = {{BROKEN_NOT_A_NUMBER, "NaN or Inf in a result"},
                                                {BROKEN_COLOUR_OVER_OPACITY, "colour outside [0, opacity]"},
                                                {BROKEN_OPACITY_OVER_ONE, "opacity outside [0, 1]"},
                                                {BROKEN_BAD_DEPTH, "depth below zero"},
                                                {BROKEN_WRITES_BEHIND_BUFFER, "written outside its area"},
                                                {BROKEN_CHANGES_INPUT, "input overwritten"}};
  for (const auto& [defect, fault] : faults) {
    const Outcome outcome = run("cast", defect, {"--watchdog", "full"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const json found = summary()["watchdog"];
    ASSERT_EQ(found.size(), 1u) << fault << found.dump();
    EXPECT_EQ(found[0]["stage"], "cast/broken");
    EXPECT_EQ(found[0]["fault"], fault);
    EXPECT_GT(found[0]["count"], 0);
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("watchdog"), HasSubstr(fault)));
  }
}

TEST_F(CliStages, TheWatchdogCountsJobsOverTheirDeadline) {
  const Outcome outcome =
      run("cast", BROKEN_NONE, {"--watchdog", "outputs", "--set", "run.deadline_ms=0.001"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json found = summary()["watchdog"];
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0]["fault"], "over the deadline");
  EXPECT_EQ(found[0]["stage"], "cast/broken");
  EXPECT_EQ(found[1]["stage"], "warp/quad");
  EXPECT_GE(found[1]["count"], 3);
}

TEST_F(CliStages, OffTheWatchdogSaysNothing) {
  ASSERT_EQ(run("cast", BROKEN_NOT_A_NUMBER).exit_code, 0);
  EXPECT_FALSE(summary().contains("watchdog"));
  EXPECT_FALSE(summary().contains("watchdog_level"));
  const Outcome refused = run("cast", BROKEN_NONE, {"--watchdog", "everything"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("run.watchdog"), HasSubstr("outputs")));
}

TEST_F(CliStages, ACostStageThatIsNotThereIsRefused) {
  place_.write("s.toml", session);
  const Outcome outcome = place_.brace({"run", "s.toml", "--set", "clock.cost=stage:nothing"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("clock.cost"), HasSubstr("nothing")));
}

}  // namespace
}  // namespace brace
