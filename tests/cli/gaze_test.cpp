// Where the eyes look, through the command: traces with gaze, scripts, and rays and errors that follow them.
#include <algorithm>
#include <cmath>

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
resolution_scale = 0.06
tracker = "ideal"
[trace]
neck = { motion = "still" }
[scene]
volume = "generator:fractal_vessels:24"
transfer_function = "ct-soft-tissue"
size_m = 0.8
position = "front:0.6"
[pipeline]
warp = "none"
rays = "mab"
[stage.mab]
map = "eccentricity"
[output]
images = "list:4"
error = "list:4"
[run]
frames = 6
)";

class Gaze : public ::testing::Test {
 protected:
  Outcome try_run(const std::string& name, const std::vector<std::string>& settings) {
    return test::run_session(place_, session, name, settings);
  }
  void run(const std::string& name, const std::vector<std::string>& settings) {
    const Outcome outcome = try_run(name, settings);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  std::vector<double> column(const std::string& name, const std::string& column) {
    return test::csv_column(place_.read(name + "/frames.csv"), column);
  }
  double weighted(const std::string& name) {
    return nlohmann::json::parse(place_.read(name + "/summary.json"))["weighted_rmse"]["mean"];
  }
  void expect_refusal(const std::vector<std::string>& settings, const std::string& words) {
    const Outcome outcome = try_run("refused", settings);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(words));
  }
  Workplace place_;
};

TEST_F(Gaze, TracesAreMadeAndToldApartByIt) {
  ASSERT_EQ(place_
                .brace({"trace", "generate", "still", "eyes.trace", "--seconds", "20", "--rate", "90",
                        "--gaze", "saccades", "--blinks", "20"})
                .exit_code,
            0);
  const Outcome info = place_.brace({"trace", "info", "eyes.trace", "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  const nlohmann::json json = nlohmann::json::parse(info.out);
  EXPECT_GT(json["gaze"]["blinks"], 1);
  EXPECT_GT(json["gaze"]["speed_deg_s"]["max"], 200.0);
  EXPECT_EQ(json["repairs"]["gaze_lost"], json["gaze"]["lost"]);
  EXPECT_THAT(place_.brace({"trace", "info", "eyes.trace"}).out, HasSubstr("deg off straight ahead"));
  ASSERT_EQ(place_.brace({"trace", "convert", "eyes.trace", "eyes.csv"}).exit_code, 0);
  const nlohmann::json table =
      nlohmann::json::parse(place_.brace({"trace", "info", "eyes.csv", "--json"}).out);
  EXPECT_EQ(table["gaze"], json["gaze"]);
  ASSERT_EQ(place_.brace({"trace", "generate", "still", "blind.trace", "--rate", "90"}).exit_code, 0);
  EXPECT_THAT(place_.brace({"trace", "info", "blind.trace"}).out, HasSubstr("gaze           none"));
  const Outcome blinks = place_.brace({"trace", "generate", "still", "x.trace", "--blinks", "3"});
  EXPECT_EQ(blinks.exit_code, 2);
  EXPECT_THAT(blinks.err, HasSubstr("--gaze saccades or pursuit"));
}

TEST_F(Gaze, AScriptThatStandsStillIsAFixedGaze) {
  run("fixed", {"stage.mab.gaze_x=0.4", "stage.mab.gaze_y=-0.2"});
  run("script", {"stage.mab.gaze=script", "gaze.script=[[0, 0.4, -0.2]]"});
  for (const char* eye : {"left", "right"}) {
    const std::string file = std::string("/images/000004_") + eye + ".png";
    EXPECT_TRUE(place_.read("fixed" + file) == place_.read("script" + file)) << eye;
  }
  EXPECT_EQ(column("script", "gaze_x").back(), 0.4);
  EXPECT_EQ(column("script", "gaze_y").back(), -0.2);
  EXPECT_EQ(column("script", "gaze_error_rad").back(), 0.0);
}

TEST_F(Gaze, ErrorsAreWeighedWhereTheEyesTrulyLook) {
  // The eyes look to the left; fine rays are there, or to the right.
  run("there", {"gaze.script=[[0, -0.4, 0]]", "stage.mab.gaze_x=-0.4"});
  run("elsewhere", {"gaze.script=[[0, -0.4, 0]]", "stage.mab.gaze_x=0.4"});
  EXPECT_GT(weighted("there"), 0.0);
  EXPECT_GT(weighted("elsewhere"), 1.3 * weighted("there"));
}

TEST_F(Gaze, AJumpReachesTheRaysAfterTheTrackersLatency) {
  const auto rays_of = [&](const std::string& name, const std::string& latency_ms) {
    run(name, {"stage.mab.gaze=script", "gaze.script=[[0, 0, 0], [0.1, 0, 0], [0.1, 4, 4]]",
               "gaze.latency_ms=" + latency_ms, "run.frames=30", "output.images=none", "output.error=list:29",
               "clock.cost=scripted", "clock.script=[{ from_s = 0, cast_ms = 2, warp_ms = 1 }]"});
    std::vector<double> rays = test::csv_column(place_.read(name + "/costs.csv"), "rays");
    std::erase(rays, 0.0);
    return rays;
  };
  const auto first_changed = [](const std::vector<double>& rays) {
    return std::find_if(rays.begin(), rays.end(), [&](double count) { return count != rays.front(); }) -
           rays.begin();
  };
  // At 90 Hz frame 9 is the first to start after 0.1 s; 50 ms later it is frame 14.
  EXPECT_EQ(first_changed(rays_of("at-once", "0")), 9);
  EXPECT_EQ(first_changed(rays_of("late", "50")), 14);
  const std::vector<double> error = column("late", "gaze_error_rad");
  EXPECT_GT(*std::max_element(error.begin(), error.end()), 1.3) << "the eyes are elsewhere until then";
  EXPECT_EQ(error.back(), 0.0);
}

TEST_F(Gaze, TheTracesGazeMovesTheRays) {
  ASSERT_EQ(place_
                .brace({"trace", "generate", "still", "eyes.trace", "--seconds", "1", "--rate", "90",
                        "--gaze", "pursuit"})
                .exit_code,
            0);
  std::string with_file = session;
  const std::string neck = "neck = { motion = \"still\" }";
  with_file.replace(with_file.find(neck), neck.size(), "file = \"eyes.trace\"");
  // Without pictures, too: work is probed with the gaze of its time.
  const Outcome outcome =
      test::run_session(place_, with_file, "eyes",
                        {"stage.mab.gaze=trace", "run.frames=60", "output.images=none", "output.error=none"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<double> x = column("eyes", "gaze_x");
  EXPECT_NE(x[20], x[50]);
  const std::vector<double> rays = column("eyes", "rays");
  EXPECT_NE(rays[20], rays[50]);
}

TEST_F(Gaze, WhatThereIsNotIsRefusedByName) {
  expect_refusal({"stage.mab.gaze=trace"}, "has no columns gaze_x gaze_y gaze_z");
  expect_refusal({"stage.mab.gaze=script"}, "there is no 'gaze.script'");
  expect_refusal({"stage.mab.gaze=trace", "gaze.script=[[0, 0, 0]]"}, "beside 'gaze.script'");
  expect_refusal({"gaze.script=[[0, 0]]"}, "an entry of 'gaze.script' is [seconds from 0, x, y]");
  expect_refusal({"gaze.script=[[0, 5, 0]]"}, "tangents from -4 to 4");
  expect_refusal({"gaze.script=[[1, 0, 0], [0, 0, 0]]"}, "in rising time");
  expect_refusal({"gaze.script=[]"}, "'gaze.script' is empty");
  expect_refusal({"gaze.latency_ms=-1"}, "gaze.latency_ms");
}

}  // namespace
}  // namespace brace
