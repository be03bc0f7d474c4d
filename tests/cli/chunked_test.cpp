// schedule/chunked through the command: its pictures are those of a whole frame.
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

TEST_F(ChunkedRun, WhatCannotBeCastInCellsIsRefusedByName) {
  for (const auto& [setting, words] :
       {std::pair<std::string, std::string>{"pipeline.cast=native", "cast/native"},
        {"run.watchdog=outputs", "run.watchdog"}}) {
    const Outcome outcome = try_run("a", {"pipeline.schedule=chunked", setting});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("schedule/chunked does not work with " + words));
  }
  const Outcome composed =
      try_run("a", {"pipeline.schedule=chunked", "stage.chunked.order=gaze", "pipeline.stereo=layers"});
  EXPECT_EQ(composed.exit_code, 2);
  EXPECT_THAT(composed.err, HasSubstr("does not work with stereo/layers"));
  EXPECT_EQ(try_run("a", {"pipeline.schedule=chunked", "stage.chunked.columns=0"}).exit_code, 2);
  EXPECT_THAT(place_.names(), ::testing::ElementsAre("s.toml"));
}

}  // namespace
}  // namespace brace
