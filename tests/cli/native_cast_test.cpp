// cast/native through the command, with what goes through every raycaster: lists of rays of rays/mab, cells
// of schedule/chunked. The pictures are those of cast/dvr on every instruction set there is.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/image.hpp"
#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;
using ::testing::HasSubstr;

// 65 x 72 pixels: no multiple of a tile or a packet.
const std::string session = R"([device]
profile = "htc-vive"
resolution_scale = 0.06
tracker = "ideal"
[trace]
neck = { motion = "rotation", degrees = 20, seconds = 0.3 }
[scene]
volume = "generator:fractal_vessels:29"
transfer_function = "ct-soft-tissue"
size_m = 0.5
position = "front:0.6"
[clock]
cost = "model:gtx-1080"
[output]
images = "list:3"
error = "none"
[run]
frames = 4
)";

class NativeCastRun : public ::testing::Test {
 protected:
  void run(const std::string& name, const std::vector<std::string>& settings) {
    const Outcome outcome = test::run_session(place_, session, name, settings);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  ImageRgba8 picture(const std::string& name, const std::string& eye) {
    return read_png(place_ / name / "images" / ("000003_" + eye + ".png"));
  }
  double total(const std::string& name, const std::string& column) {
    double sum = 0.0;
    for (const double value : test::csv_column(place_.read(name + "/frames.csv"), column))
      sum += value;
    return sum;
  }
  /// What `instructions` takes beside auto, from the parameter's own refusal.
  std::vector<std::string> instruction_sets() {
    const std::string words =
        test::run_session(place_, session, "no", {"pipeline.cast=native", "stage.native.instructions=no"})
            .err;
    std::vector<std::string> found;
    for (const char* set : {"avx512", "avx2", "sse4", "neon", "scalar"})
      if (words.find(set) != std::string::npos) found.emplace_back(set);
    EXPECT_THAT(found, ::testing::Contains("scalar")) << words;
    return found;
  }
  void expect_pictures_of_dvr(const std::vector<std::string>& settings, double casts_of_dvr = 1.0) {
    run("dvr", settings);
    std::vector<std::string> native = settings;
    native.insert(native.end(), {"pipeline.cast=native", ""});
    for (const std::string& set : instruction_sets()) {
      native.back() = "stage.native.instructions=" + set;
      run(set, native);
      for (const char* eye : {"left", "right"}) {
        const ImageRgba8 a = picture("dvr", eye), b = picture(set, eye);
        ASSERT_EQ(a.pixels.size(), b.pixels.size());
        int largest = 0, brightest = 0;
        for (std::size_t i = 0; i < a.pixels.size(); ++i) {
          const Rgba8 &p = a.pixels[i], &q = b.pixels[i];
          largest = std::max({largest, std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
          brightest = std::max({brightest, int{p.r}, int{p.g}, int{p.b}});
        }
        EXPECT_LE(largest, 1) << set << ' ' << eye;
        EXPECT_GT(brightest, 50) << "there is something to see";
      }
      EXPECT_EQ(casts_of_dvr * total(set, "rays"), total("dvr", "rays")) << set;
      EXPECT_NEAR(casts_of_dvr * total(set, "samples") / total("dvr", "samples"), 1.0, 1e-3) << set;
    }
  }
  Workplace place_;
};

TEST_F(NativeCastRun, TakesTheRaysOfAnAtlas) {
  expect_pictures_of_dvr({"pipeline.rays=mab", "stage.mab.gaze=script", "gaze.script=[[0, 0.14, -0.05]]",
                          "pipeline.skip=distance_map"});
}

TEST_F(NativeCastRun, CastsInCells) {
  expect_pictures_of_dvr(
      {"pipeline.schedule=chunked", "stage.chunked.columns=3", "stage.chunked.rows=5", "pipeline.rays=mab"});
}

TEST_F(NativeCastRun, CastsCellsFromTheirOwnPoses) {
  expect_pictures_of_dvr({"pipeline.schedule=chunked", "stage.chunked.columns=3", "stage.chunked.poses=cell",
                          "stage.chunked.swap=cell"});
}

TEST_F(NativeCastRun, TellsLayersOfItsSegments) {
  expect_pictures_of_dvr({"pipeline.stereo=layers", "pipeline.skip=distance_map", "scene.shading=phong"});
}

TEST_F(NativeCastRun, CastsRaysForTheHolesOfComposedEyes) {
  // Their buffers are those of a wider grid: that of the middle, or of rectified pictures.
  for (const char* reference : {"stage.layers.reference=left", "stage.layers.reference=middle"})
    expect_pictures_of_dvr({"pipeline.stereo=layers", reference, "scene.position=front:0.9",
                            "scene.volume=generator:solid_box:24", "scene.transfer_function=tf3",
                            "device.resolution_scale=0.1"});
}

TEST_F(NativeCastRun, TellsNobodyWhereLayersAreLeftOut) {
  run("tiny", {"pipeline.stereo=layers", "pipeline.cast=native", "scene.size_m=0.001"});
  EXPECT_THAT(place_.read("tiny/summary.json"), ::testing::HasSubstr("no layers"));
}

TEST_F(NativeCastRun, TellsNovelViewsOfItsSegments) {
  expect_pictures_of_dvr({"pipeline.stereo=novel_view", "stage.novel_view.reference=middle"});
}

TEST_F(NativeCastRun, TellsOfTheSegmentsOfAnAtlas) {
  expect_pictures_of_dvr({"pipeline.stereo=layers", "pipeline.rays=mab"});
  expect_pictures_of_dvr({"pipeline.stereo=novel_view", "pipeline.rays=mab"});
}

TEST_F(NativeCastRun, TellsOfTheSegmentsOfCells) {
  expect_pictures_of_dvr({"pipeline.stereo=novel_view", "pipeline.schedule=chunked",
                          "stage.chunked.columns=3", "stage.chunked.rows=5"});
}

TEST_F(NativeCastRun, TellsWarpsOfItsSegments) {
  expect_pictures_of_dvr({"pipeline.warp=volumetric", "stage.volumetric.layering=thresholds"});
  // Shares of what a ray will be: the kernel casts it twice, here that is known when segments are told.
  expect_pictures_of_dvr({"pipeline.warp=volumetric", "stage.volumetric.layering=equal",
                          "clock.cost=scripted", "clock.script=[{from_s=0,cast_ms=2,warp_ms=1}]"},
                         2.0);
}

}  // namespace
}  // namespace brace
