// A transfer function that changes during a run: the pictures before and after are those of runs that had the
// one or the other all along, and the change is a job of its own.
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/image.hpp"
#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;
using testing::HasSubstr;

const std::string session = R"([device]
profile = "htc-vive"
resolution_scale = 0.03
lens = "none"
tracker = "ideal"
[trace]
neck = { motion = "still", seconds = 0.3 }
[scene]
volume = "generator:nested_shells:24"
transfer_function = "tf1"
[pipeline]
warp = "none"
skip = "partitioned"
[output]
images = "list:3,9"
error = "every:1"
[run]
frames = 12
)";

const std::string change = "[[scene.transfer_change]]\nat_s = 0.06\ntransfer_function = 'tf3'\n";

class CliTransfer : public testing::Test {
 protected:
  void run(const std::string& out, const std::string& text, const std::vector<std::string>& more = {}) {
    place_.write(out + ".toml", text);
    std::vector<std::string> arguments = {"run", out + ".toml", "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = place_.brace(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  std::string picture(const std::string& out, const std::string& vsync) const {
    return place_.read(out + "/images/" + vsync + "_left.png") +
           place_.read(out + "/images/" + vsync + "_right.png");
  }
  std::vector<std::string> updates(const std::string& out) const {
    std::istringstream lines(place_.read(out + "/costs.csv"));
    std::vector<std::string> found;
    for (std::string line; std::getline(lines, line);)
      if (line.find(",update,") != std::string::npos) found.push_back(line);
    return found;
  }
  Workplace place_;
};

TEST_F(CliTransfer, PicturesBeforeAndAfterAChangeAreThoseOfTheTwoTransferFunctions) {
  run("changed", session + change);
  run("first", session);
  run("second", session, {"--set", "scene.transfer_function=tf3"});
  EXPECT_EQ(picture("changed", "000003"), picture("first", "000003"));
  EXPECT_EQ(picture("changed", "000009"), picture("second", "000009"));
  EXPECT_NE(picture("first", "000009"), picture("second", "000009"));
  EXPECT_TRUE(updates("first").empty());
  ASSERT_EQ(updates("changed").size(), 1U);
  EXPECT_THAT(place_.read("changed/timeline.json"), HasSubstr("\"updates\""));

  // The change is at 60 ms, vsync 5 lights at 55.6 ms + 11 ms: the eye should see the new function there, and
  // does so one frame after the cast that follows.
  std::istringstream lines(place_.read("changed/frames.csv"));
  std::string line;
  std::getline(lines, line);
  std::vector<std::string> names;
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');)
    names.push_back(name);
  const auto dssim = std::find(names.begin(), names.end(), "dssim_left") - names.begin();
  std::vector<double> errors;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (std::ptrdiff_t i = 0; i <= dssim; ++i)
      std::getline(cells, cell, ',');
    errors.push_back(cell.empty() ? -1.0 : std::stod(cell));
  }
  ASSERT_EQ(errors.size(), 12U);
  EXPECT_EQ(errors[3], 0.0);
  EXPECT_GT(errors[6], 0.0) << "the old transfer function is still on the panel";
  EXPECT_EQ(errors[9], 0.0);
}

TEST_F(CliTransfer, WithoutPicturesTheSameUpdateIsCounted) {
  run("pixels", session + change);
  run("counted", session + change, {"--set", "output.images=none", "--set", "output.error=none"});
  EXPECT_EQ(updates("pixels"), updates("counted"));
}

TEST_F(CliTransfer, AnAnimationIsAnUpdateBeforeEachFrameAndTheSameTwice) {
  const std::vector<std::string> animated = {
      "--set", "scene.transfer_animation={level=[60,200],window=[100,50],seconds=0.2}", "--set",
      "pipeline.skip=bitmask"};
  run("a", session, animated);
  run("b", session, animated);
  EXPECT_EQ(updates("a").size(), 10U) << "frames 1 to 10; the last vsync starts none";
  EXPECT_EQ(place_.read("a/costs.csv"), place_.read("b/costs.csv"));
  EXPECT_EQ(picture("a", "000009"), picture("b", "000009"));
  EXPECT_NE(picture("a", "000009"), picture("a", "000003"));
}

TEST_F(CliTransfer, AMissingTransferFunctionOfALaterChangeIsToldBeforeTheRun) {
  place_.write("bad.toml", session + "[[scene.transfer_change]]\nat_s = 0.06\ntransfer_function = 'tf33'\n");
  const Outcome outcome = place_.brace({"run", "bad.toml", "--out", "bad"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("tf33"));
  EXPECT_EQ(place_.names(), std::vector<std::string>{"bad.toml"});
}

TEST_F(CliTransfer, AutoTakesNothingForAFullSceneAndPartitionsWhereTheTransferFunctionChanges) {
  const std::vector<std::string> no_pictures = {"--set", "output.images=none", "--set", "output.error=none",
                                                "--set", "pipeline.skip=auto"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), no_pictures.begin(), no_pictures.end());
    return more;
  };
  run("full", session, with({"--set", "scene.transfer_function=tf2"}));
  EXPECT_THAT(place_.read("full/summary.json"), HasSubstr("none: 100.0 % of the blocks are occupied"));
  EXPECT_THAT(place_.read("full/summary.json"), HasSubstr("\"skip\": \"skip/none\""));
  run("sparse", session,
      with({"--set", "scene.transfer_function=tf3", "--set", "scene.volume=generator:fractal_vessels:32"}));
  EXPECT_THAT(place_.read("sparse/summary.json"), HasSubstr("\"skip\": \"skip/distance_map\""));
  run("changes", session + "[[scene.transfer_change]]\nat_s = 0.06\ntransfer_function = 'tf4'\n",
      with({"--set", "scene.transfer_function=tf3", "--set", "scene.volume=generator:fractal_vessels:32"}));
  EXPECT_THAT(place_.read("changes/summary.json"), HasSubstr("\"skip\": \"skip/partitioned\""));
  EXPECT_THAT(place_.read("changes/summary.json"), HasSubstr("skip/auto"));
  EXPECT_EQ(updates("changes").size(), 1U);
}

}  // namespace
}  // namespace brace
