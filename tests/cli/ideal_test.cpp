// Ideal pictures: made in batches and once, by the raycaster that is asked for; the errors are those of one
// vsync at a time.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* figures[] = {"dssim_left", "dssim_right", "weighted_rmse_left", "weighted_rmse_right"};

class Ideal : public testing::Test {
 protected:
  Ideal() {
    place_.write("s.toml", R"([device]
profile = "htc-vive"
resolution_scale = 0.1
[trace]
neck = { motion = "rotation" }
[scene]
volume = "generator:nested_shells:32"
transfer_function = "tf3"
size_m = 0.4
position = "front:0.8"
[clock]
cost = "scripted"
script = [{ from_s = 0, cast_ms = 14, warp_ms = 1 }]
[output]
error = "every:1"
images = "none"
[run]
frames = 21
)");
  }
  Outcome brace(const char* command, const std::string& out, const std::vector<std::string>& settings) {
    std::vector<std::string> arguments = {command, "s.toml", "--out", out};
    for (const std::string& setting : settings)
      arguments.insert(arguments.end(), {"--set", setting});
    return place_.brace(arguments);
  }
  void run(const std::string& out, const std::vector<std::string>& settings) {
    const Outcome outcome = brace("run", out, settings);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  std::vector<double> column(const std::string& file, const char* name) {
    return test::csv_column(place_.read(file), name);
  }
  std::string note(const std::string& out) {
    const auto facts = nlohmann::json::parse(place_.read(out + "/summary.json"))["facts"];
    return facts.contains("ideal pictures") ? facts["ideal pictures"].get<std::string>() : std::string();
  }

  Workplace place_;
};

TEST_F(Ideal, ErrorsDoNotDependOnWhichVsyncsAreMeasuredTogether) {
  for (const char* cast : {"pipeline.cast=dvr", "pipeline.cast=native"}) {
    run("all", {cast});
    run("some", {cast, "output.error=list:2,3,11,20"});
    for (const char* name : figures) {
      const std::vector<double> all = column("all/frames.csv", name), some = column("some/frames.csv", name);
      ASSERT_EQ(all.size(), 21U);
      for (const std::size_t vsync : {2U, 3U, 11U, 20U})
        EXPECT_EQ(all[vsync], some[vsync]) << cast << " " << name << " " << vsync;
      EXPECT_EQ(some[4], 0.0) << name << ": an empty cell";
      EXPECT_GT(*std::max_element(all.begin() + 1, all.end()), 1e-3) << "there is an error to measure";
    }
    EXPECT_EQ(note("all"), "");
  }
}

TEST_F(Ideal, AStillHeadHasFewIdealPictures) {
  run("still", {"trace.neck.motion=still", "device.tracker=ideal"});
  int cast = 0, again = 0;
  ASSERT_EQ(std::sscanf(note("still").c_str(), "%d cast, %d again", &cast, &again), 2) << note("still");
  EXPECT_EQ(cast + again, 19) << "the panels are dark for two vsyncs";
  EXPECT_LE(cast, 4) << "poses between equal ones differ by rounding";
}

TEST_F(Ideal, SeriesShareThemWhereTheyAreTheSame) {
  const auto vary = [&](const std::string& out, const std::string& key, const std::string& values) {
    const Outcome outcome = brace("run", out, {"compare.key=" + key, "compare.values=" + values});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  vary("warps", "pipeline.warp", "[\"none\",\"quad\"]");
  const std::string summary = place_.read("warps/summary.json");
  EXPECT_THAT(summary, HasSubstr("0 cast, 19 again"));
  run("quad", {"pipeline.warp=quad"});
  for (const char* name : figures)
    EXPECT_EQ(column("warps/frames-quad.csv", name), column("quad/frames.csv", name)) << name;
  // What shows in the picture is not shared.
  vary("steps", "stage.dvr.step_voxels", "[0.5,1.0]");
  EXPECT_THAT(place_.read("steps/summary.json"), testing::Not(HasSubstr("ideal pictures")));
}

TEST_F(Ideal, NativeIsAsGoodAReference) {
  run("session", {"scene.shading=phong"});
  run("native", {"scene.shading=phong", "output.ideal_cast=native"});
  for (const char* name : figures) {
    const std::vector<double> session = column("session/frames.csv", name),
                              native = column("native/frames.csv", name);
    for (std::size_t vsync = 1; vsync < session.size(); ++vsync)
      EXPECT_NEAR(session[vsync], native[vsync], 2e-3) << name << " " << vsync;
  }
  EXPECT_NE(column("session/frames.csv", figures[0]), column("native/frames.csv", figures[0]))
      << "another raycaster rounds in another way";
  run("same", {"output.ideal_cast=native", "pipeline.cast=native"});
  run("own", {"pipeline.cast=native"});
  EXPECT_EQ(place_.read("same/frames.csv"), place_.read("own/frames.csv"));
}

TEST_F(Ideal, NativeFollowsTheLinesOfTheScanOut) {
  run("dvr", {"output.ideal_pose=lines"});
  run("native", {"output.ideal_pose=lines", "output.ideal_cast=native"});
  run("middle", {});
  double apart = 0.0;
  for (const char* name : figures) {
    const std::vector<double> dvr = column("dvr/frames.csv", name),
                              native = column("native/frames.csv", name),
                              middle = column("middle/frames.csv", name);
    for (std::size_t vsync = 1; vsync < dvr.size(); ++vsync) {
      EXPECT_NEAR(dvr[vsync], native[vsync], 2e-3) << name << " " << vsync;
      apart = std::max(apart, std::abs(dvr[vsync] - middle[vsync]));
    }
  }
  EXPECT_GT(apart, 1e-4) << "the pose moves from line to line";
}

TEST_F(Ideal, NativeIsRefusedByNameWhereItCannotStandForTheSessions) {
  const std::vector<std::vector<std::string>> cases = {{"output.ideal=converged"},
                                                       {"stage.dvr.tolerance=1e-3"},
                                                       {"stage.dvr.integrator=left"},
                                                       {"pipeline.skip=occlusion"}};
  for (std::vector<std::string> settings : cases) {
    settings.push_back("output.ideal_cast=native");
    const Outcome outcome = brace("run", "refused", settings);
    EXPECT_EQ(outcome.exit_code, 2) << settings.front();
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("s.toml"), HasSubstr("output.ideal_cast"), HasSubstr("accepted")))
        << settings.front();
    EXPECT_FALSE(std::filesystem::exists(place_ / "refused"));
  }
}

}  // namespace
}  // namespace brace
