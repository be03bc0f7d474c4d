// stereo/layers and stereo/novel_view through the command: their pictures beside those of two passes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/image.hpp"
#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;
using ::testing::HasSubstr;

const std::string session = R"([device]
profile = "htc-vive"
resolution_scale = 0.06
lens = "none"
tracker = "ideal"
[trace]
neck = { motion = "rotation", degrees = 20, seconds = 0.3 }
[scene]
volume = "generator:fractal_vessels:24"
transfer_function = "ct-soft-tissue"
size_m = 0.5
position = "front:0.9"
[clock]
cost = "model:gtx-1080"
[pipeline]
warp = "none"
[output]
images = "list:4"
[run]
frames = 6
)";

class Stereo : public ::testing::Test {
 protected:
  Outcome run(const std::string& name, std::vector<std::string> settings) {
    return test::run_session(place_, session, name, settings);
  }
  ImageRgba8 picture(const std::string& name, const char* eye) {
    return read_png(place_ / name / "images" / (std::string("000004_") + eye + ".png"));
  }
  /// Of all casts, from costs.csv.
  double samples(const std::string& name) {
    const std::vector<double> counts = test::csv_column(place_.read(name + "/costs.csv"), "samples");
    return std::accumulate(counts.begin(), counts.end(), 0.0);
  }
  nlohmann::json summary(const std::string& name) {
    return nlohmann::json::parse(place_.read(name + "/summary.json"));
  }
  Workplace place_;
};

int largest_difference(const ImageRgba8& a, const ImageRgba8& b) {
  int largest = 0;
  for (int y = 0; y < a.height_px; ++y) {
    for (int x = 0; x < a.width_px; ++x) {
      const auto &p = a.at(x, y), &q = b.at(x, y);
      largest = std::max({largest, std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
    }
  }
  return largest;
}

double mean_difference(const ImageRgba8& a, const ImageRgba8& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height_px; ++y)
    for (int x = 0; x < a.width_px; ++x)
      sum += std::abs(a.at(x, y).r - b.at(x, y).r);
  return sum / (a.width_px * a.height_px);
}

void expect_same_inside(const ImageRgba8& two, const ImageRgba8& one) {
  // Away from the edges of the box, where the path's length has kinks that pixels of both eyes cut elsewhere:
  // where the picture is smooth.
  int inside = 0;
  for (int y = 1; y + 1 < two.height_px; ++y) {
    for (int x = 1; x + 1 < two.width_px; ++x) {
      int lowest = 255, highest = 0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          lowest = std::min<int>(lowest, two.at(x + dx, y + dy).r);
          highest = std::max<int>(highest, two.at(x + dx, y + dy).r);
        }
      }
      if (lowest == 0 || highest - lowest > 3) continue;
      ASSERT_LT(highest, 200);
      ++inside;
      EXPECT_NEAR(one.at(x, y).r, two.at(x, y).r, 2) << x << " " << y;
    }
  }
  EXPECT_GT(inside, 20);
}

TEST_F(Stereo, CastEyeIsThatOfTwoPassesBitForBitAndTheOtherClose) {
  ASSERT_EQ(run("two", {}).exit_code, 0);
  for (const std::string stage : {"layers", "novel_view"}) {
    const Outcome outcome = run(stage, {"pipeline.stereo=" + stage});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(largest_difference(picture("two", "left"), picture(stage, "left")), 0) << stage;
    const double eyes_apart = mean_difference(picture("two", "left"), picture("two", "right"));
    const double error = mean_difference(picture("two", "right"), picture(stage, "right"));
    EXPECT_GT(eyes_apart, 0.5);
    EXPECT_LT(error, 0.25 * eyes_apart) << stage;
    EXPECT_LT(samples(stage), 0.7 * samples("two")) << stage;
  }
  EXPECT_THAT(run("said", {"pipeline.stereo=layers"}).err, HasSubstr("layers of"));
}

TEST_F(Stereo, SkippingChangesNoPictureOfEitherEye) {
  ASSERT_EQ(
      run("none", {"pipeline.stereo=layers", "pipeline.skip=none", "scene.transfer_function=tf3"}).exit_code,
      0);
  for (const std::string skip : {"distance_map", "octree"}) {
    const Outcome outcome =
        run(skip, {"pipeline.stereo=layers", "pipeline.skip=" + skip, "scene.transfer_function=tf3"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char* eye : {"left", "right"})
      EXPECT_EQ(largest_difference(picture("none", eye), picture(skip, eye)), 0) << skip << " " << eye;
    EXPECT_LT(samples(skip), samples("none")) << skip;
  }
}

TEST_F(Stereo, HomogeneousSlabIsTheSameInBothPasses) {
  // Translucent: an opaque one would hide wrong path lengths.
  place_.write("thin.toml", R"(name = "thin"
domain = "fraction"
points = [
  { value = 0.0, r = 1.0, g = 0.5, b = 0.25, opacity = 0.04 },
  { value = 1.0, r = 1.0, g = 0.5, b = 0.25, opacity = 0.04 },
]
)");
  const std::vector<std::string> slab = {"scene.volume=generator:slab:16", "scene.size_m=0.5",
                                         "scene.transfer_function=thin.toml"};
  ASSERT_EQ(run("two", slab).exit_code, 0);
  for (const std::string stage : {"layers", "novel_view"}) {
    std::vector<std::string> once = slab;
    once.insert(once.end(), {"pipeline.stereo=" + stage, "stage.layers.format=rgba32f"});
    ASSERT_EQ(run(stage, once).exit_code, 0);
    expect_same_inside(picture("two", "right"), picture(stage, "right"));
  }
}

TEST_F(Stereo, NovelViewIsRefusedByNameWhereItsLayersCannotBeMade) {
  for (const char* setting : {"run.watchdog=full", "stage.chunked.order=cost", "pipeline.warp=volumetric"}) {
    std::vector<std::string> settings = {"pipeline.stereo=novel_view", setting};
    if (std::string(setting) == "stage.chunked.order=cost") settings.push_back("pipeline.schedule=chunked");
    const Outcome outcome = run("one", settings);
    EXPECT_EQ(outcome.exit_code, 2) << setting;
    EXPECT_THAT(outcome.err, HasSubstr("stereo/novel_view")) << setting;
  }
}

TEST_F(Stereo, WhatOnlyTheRightEyeSeesGetsRaysOfItsOwn) {
  // An opaque box whose right side lies between the eyes.
  const std::vector<std::string> box = {"scene.volume=generator:solid_box:24", "device.resolution_scale=0.15",
                                        "trace.neck.motion=still"};
  const auto fresh_rays = [&](const std::string& stage, const char* position) {
    std::vector<std::string> settings = box;
    settings.insert(settings.end(), {"pipeline.stereo=" + stage, position});
    EXPECT_EQ(run("one", settings).exit_code, 0);
    return std::stod(summary("one")["facts"]["stereo/" + stage + ", frames"].get<std::string>());
  };
  const char* beside = "scene.position=-0.125,1.6,-0.6";
  for (const std::string stage : {"layers", "novel_view"}) {
    EXPECT_GT(fresh_rays(stage, beside), 20.0) << stage;
    EXPECT_LT(fresh_rays(stage, "scene.position=0,1.6,-3"), 3.0) << stage;
  }
  // They show it: without, the picture is farther from that of two passes; the rest of the difference is
  // elsewhere.
  std::vector<std::string> settings = box;
  settings.push_back(beside);
  ASSERT_EQ(run("two", settings).exit_code, 0);
  settings.push_back("pipeline.stereo=layers");
  ASSERT_EQ(run("fresh", settings).exit_code, 0);
  settings.push_back("stage.layers.holes=none");
  ASSERT_EQ(run("none", settings).exit_code, 0);
  const double without = mean_difference(picture("two", "right"), picture("none", "right"));
  EXPECT_LT(mean_difference(picture("two", "right"), picture("fresh", "right")), 0.98 * without);
}

TEST_F(Stereo, MemoryOfLayersIsSaidAndIsThatOfTheSourcesFormula) {
  const std::vector<std::string> less = {"output.images=none", "output.error=none", "run.frames=1",
                                         "stage.layers.layers=9"};
  const std::map<std::string, double> bytes_per_texel = {{"rgba8", 4}, {"rgba16f", 8}, {"rgba32f", 16}};
  for (const auto& [format, bytes] : bytes_per_texel) {
    std::vector<std::string> settings = less;
    settings.insert(settings.end(), {"pipeline.stereo=layers", "stage.layers.format=" + format});
    const Outcome outcome = run(format, settings);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    int width = 0, height = 0;  // the Vive's rows of both eyes lie between each other: a few more than 72
    const std::size_t said = outcome.err.find("9 layers of ");
    ASSERT_NE(said, std::string::npos) << outcome.err;
    ASSERT_EQ(std::sscanf(outcome.err.c_str() + said, "9 layers of %d x %d px", &width, &height), 2);
    EXPECT_EQ(width, 65);
    EXPECT_NEAR(height, 74, 2);
    EXPECT_THAT(outcome.err, HasSubstr("px in " + format));
    const double mib = width * height * 9 * bytes / (1024.0 * 1024.0);
    EXPECT_NEAR(summary(format)["stereo_layer_mib"].get<double>(), mib, 1e-9);
  }
  std::vector<std::string> too_much = less;
  too_much.insert(too_much.end(), {"pipeline.stereo=layers", "stage.layers.layers=4096",
                                   "device.resolution_scale=1", "stage.layers.format=rgba32f"});
  const Outcome refused = run("much", too_much);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("what fits: stage.\"layers\".layers = "));
  EXPECT_THAT(run("novel", {"pipeline.stereo=novel_view"}).err, HasSubstr("4 layers of"));
}

TEST_F(Stereo, NovelViewWorksWithWarpsThatReadDepth) {
  ASSERT_EQ(run("two", {"pipeline.warp=grid"}).exit_code, 0);
  ASSERT_EQ(run("one", {"pipeline.warp=grid", "pipeline.stereo=novel_view"}).exit_code, 0);
  const double apart = mean_difference(picture("two", "left"), picture("two", "right"));
  EXPECT_LT(mean_difference(picture("two", "right"), picture("one", "right")), 0.3 * apart);
}

TEST_F(Stereo, TooNearForTheLayersIsCastTwiceAndCounted) {
  const std::vector<std::string> near = {"scene.position=front:0.5", "stage.layers.layers=2"};
  std::vector<std::string> layers = near;
  layers.push_back("pipeline.stereo=layers");
  const Outcome outcome = run("one", layers);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  ASSERT_EQ(run("two", {"scene.position=front:0.5"}).exit_code, 0);
  EXPECT_EQ(largest_difference(picture("two", "right"), picture("one", "right")), 0);
  EXPECT_THAT(place_.read("one/report.html"), HasSubstr("ray cast twice"));
}

TEST_F(Stereo, VolumeBehindTheEyesIsNotSeen) {
  for (const char* stage : {"pipeline.stereo=novel_view", "pipeline.stereo=layers"}) {
    const Outcome outcome = run("one", {stage, "scene.position=front:-2"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(largest_difference(picture("one", "left"), picture("one", "right")), 0) << stage;
  }
  EXPECT_EQ(place_.read("one/report.html").find("ray cast twice"), std::string::npos);
}

TEST_F(Stereo, LessThanAPixelOfDisparityLeavesTheStageOut) {
  const Outcome outcome =
      run("one", {"pipeline.stereo=layers", "stage.layers.near_m=20", "scene.position=front:30"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  bool said = false;
  const nlohmann::json one = summary("one");
  for (const auto& left_out : one["left_out"])
    said = said || left_out["stage"] == "stereo";
  EXPECT_TRUE(said);
}

TEST_F(Stereo, CantedDisplaysAreTakenAndLayersRectifyThemFirst) {
  ASSERT_EQ(run("two", {"device.profile=valve-index"}).exit_code, 0);
  const double apart = mean_difference(picture("two", "left"), picture("two", "right"));
  for (const std::string stage : {"layers", "novel_view"}) {
    const Outcome outcome = run(stage, {"pipeline.stereo=" + stage, "device.profile=valve-index"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char* eye : {"left", "right"})
      EXPECT_LT(mean_difference(picture("two", eye), picture(stage, eye)), 0.25 * apart)
          << stage << " " << eye;
    EXPECT_LT(samples(stage), 0.8 * samples("two")) << stage;
    EXPECT_EQ(outcome.err.find("rectified first") != std::string::npos, stage == "layers") << outcome.err;
  }
}

}  // namespace
}  // namespace brace
