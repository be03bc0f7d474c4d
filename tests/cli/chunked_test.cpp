// schedule/chunked through the command: its pictures are those of a whole frame.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;
using ::testing::HasSubstr;

const std::string session = R"([device]
profile = "htc-vive"
resolution_scale = 0.05
tracker = "ideal"
[trace]
neck = { motion = "still" }
[scene]
volume = "generator:fractal_vessels:24"
transfer_function = "ct-soft-tissue"
size_m = 0.5
position = "front:0.7"
[clock]
cost = "model:gtx-1080"
[output]
images = "list:7"
error = "none"
[run]
frames = 8
)";

class ChunkedRun : public ::testing::Test {
 protected:
  Outcome try_run(const std::string& name, const std::vector<std::string>& settings) {
    return test::run_session(place_, session, name, settings);
  }
  void run(const std::string& name, const std::vector<std::string>& settings) {
    const Outcome outcome = try_run(name, settings);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  std::string picture(const std::string& name, const std::string& eye) {
    return place_.read(name + "/images/000007_" + eye + ".png");
  }
  Workplace place_;
};

TEST_F(ChunkedRun, PicturesAreThoseOfWholeFramesWithEveryRaysAndSkipStage) {
  for (const std::vector<std::string>& stages : {std::vector<std::string>{},
                                                 {"pipeline.rays=mab"},
                                                 {"pipeline.skip=distance_map", "pipeline.warp=grid"}}) {
    run("whole", stages);
    std::vector<std::string> chunked = stages;
    chunked.insert(chunked.end(),
                   {"pipeline.schedule=chunked", "stage.chunked.columns=3", "stage.chunked.rows=5"});
    run("chunked", chunked);
    chunked.push_back("stage.chunked.cut=cost");
    run("cut", chunked);
    for (const char* eye : {"left", "right"}) {
      EXPECT_TRUE(picture("whole", eye) == picture("chunked", eye)) << eye;
      EXPECT_TRUE(picture("whole", eye) == picture("cut", eye)) << eye << ", cut by cost";
    }
  }
}

// Eye frames of six periods, whose cells see the head ever further on.
const std::vector<std::string> slow = {
    "clock.cost=scripted",     "clock.script=[{from_s=0,cast_ms=60,warp_ms=1}]",
    "clock.queue=single",      "pipeline.schedule=chunked",
    "pipeline.predict=none",   "output.images=none",
    "output.error=every:3",    "run.frames=40",
    "stage.chunked.columns=4", "stage.chunked.rows=4"};

TEST_F(ChunkedRun, UnderATranslationCellsComeNearerFromPosesOfTheirOwn) {
  const auto error = [&](const std::string& poses) {
    std::vector<std::string> settings = slow;
    settings.insert(settings.end(), {"trace.neck={motion='translation',metres=0.3,seconds=0.5}",
                                     "pipeline.warp=quad", "stage.chunked.poses=" + poses});
    run(poses, settings);
    return nlohmann::json::parse(place_.read(poses + "/summary.json"))["dssim"]["mean"].get<double>();
  };
  const double of_frame = error("frame"), of_cells = error("cell");
  EXPECT_GT(of_frame, 1e-3);
  EXPECT_LT(of_cells, 0.85 * of_frame);
}

TEST_F(ChunkedRun, ByTheHostsClockVsyncsAreWaitedForAndJobsTakeWhatTheyTake) {
  for (const char* schedule : {"whole_frame", "chunked"}) {
    run("wall", {"clock.mode=wall", "clock.cost=measured", "output.images=none", "run.frames=20",
                 std::string("pipeline.schedule=") + schedule});
    const auto summary = nlohmann::json::parse(place_.read("wall/summary.json"));
    EXPECT_EQ(summary["clock"]["mode"], "wall");
    EXPECT_EQ(summary["deterministic"], false);
    EXPECT_EQ(summary["vsyncs"], 20);
    EXPECT_GE(summary["host"]["wall_s"].get<double>(), 19.0 / 90.0);
    for (const double cost : test::csv_column(place_.read("wall/costs.csv"), "cost_ns"))
      EXPECT_GT(cost, 0.0);
  }
}

TEST_F(ChunkedRun, WhatTheHostsClockCannotDoIsRefused) {
  const std::vector<std::string> wall = {"clock.mode=wall", "clock.cost=measured", "output.images=none"};
  for (const auto& [setting, words] :
       {std::pair<std::string, std::string>{"clock.cost=model:gtx-1080", "clock.cost"},
        {"clock.queue=dual", "clock.queue"},
        {"output.images=ends", "output.images"},
        {"output.error=ends", "output.error"},
        {"pipeline.rays=mab", "clock.mode = 'wall' does not work with rays/mab"}}) {
    std::vector<std::string> settings = wall;
    settings.insert(settings.end(), {"pipeline.schedule=chunked", setting});
    const Outcome outcome = try_run("a", settings);
    EXPECT_EQ(outcome.exit_code, 2) << setting;
    EXPECT_THAT(outcome.err, ::testing::AllOf(HasSubstr(words), HasSubstr("accepted: ")));
  }
}

TEST_F(ChunkedRun, CountedCellsCostWhatRenderedOnesDo) {
  const std::vector<std::string> chunked = {"pipeline.schedule=chunked", "clock.queue=single"};
  run("rendered", chunked);
  std::vector<std::string> counted = chunked;
  counted.push_back("output.images=none");
  run("counted", counted);
  const auto total = [&](const std::string& name) {
    double ns = 0.0;
    for (const double cost : test::csv_column(place_.read(name + "/costs.csv"), "cost_ns"))
      ns += cost;
    return ns;
  };
  EXPECT_NEAR(total("counted"), total("rendered"), 0.02 * total("rendered"));
}

TEST_F(ChunkedRun, CellsThatCannotBeShownOneByOneAreRefusedByName) {
  for (const auto& [setting, words] :
       {std::pair<std::string, std::string>{"stage.chunked.poses=frame", "poses = 'frame'"},
        {"stage.chunked.cut=cost", "cut = 'cost'"},
        {"clock.queue=priority", "clock.queue"}}) {
    const Outcome outcome = try_run(
        "a", {"pipeline.schedule=chunked", "stage.chunked.poses=cell", "stage.chunked.swap=cell", setting});
    EXPECT_EQ(outcome.exit_code, 2) << setting;
    EXPECT_THAT(outcome.err, ::testing::AllOf(HasSubstr("swap = 'cell' does not work with " + words),
                                              HasSubstr("accepted: ")));
  }
}

TEST_F(ChunkedRun, WhatCannotBeCastInCellsIsRefusedByName) {
  for (const char* level : {"outputs", "full"}) {
    const Outcome outcome = try_run("a", {"pipeline.schedule=chunked", std::string("run.watchdog=") + level});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("schedule/chunked does not work with run.watchdog"));
  }
  const Outcome composed =
      try_run("a", {"pipeline.schedule=chunked", "stage.chunked.order=gaze", "pipeline.stereo=layers"});
  EXPECT_EQ(composed.exit_code, 2);
  EXPECT_THAT(composed.err, HasSubstr("does not work with stereo/layers"));
  EXPECT_EQ(try_run("a", {"pipeline.schedule=chunked", "stage.chunked.columns=0"}).exit_code, 2);
  for (const char* setting : {"pipeline.rays=mab", "pipeline.stereo=layers", "pipeline.stereo=novel_view",
                              "pipeline.skip=occlusion", "pipeline.warp=volumetric"}) {
    const Outcome outcome = try_run("a", {"pipeline.schedule=chunked", "stage.chunked.poses=cell", setting});
    EXPECT_EQ(outcome.exit_code, 2) << setting;
    std::string id = std::string(setting).substr(9);
    std::replace(id.begin(), id.end(), '=', '/');
    EXPECT_THAT(outcome.err, ::testing::AllOf(HasSubstr("poses = 'cell' does not work with " + id),
                                              HasSubstr("accepted: ")));
  }
  EXPECT_THAT(place_.names(), ::testing::ElementsAre("s.toml"));
}

}  // namespace
}  // namespace brace
