// scene.shading by additional samples, through the command: both ray casters show the same, and models price
// what is counted.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/image.hpp"
#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;
using ::testing::HasSubstr;

const std::string session = R"([device]
profile = "htc-vive"
resolution_scale = 0.05
lens = "none"
tracker = "ideal"
[trace]
neck = { motion = "rotation", degrees = 20, seconds = 0.3 }
[scene]
volume = "generator:nested_shells:24"
transfer_function = "ct-soft-tissue"
size_m = 0.5
position = "front:0.8"
[clock]
cost = "model:gtx-1080"
cost_resolution = "as_rendered"
[pipeline]
warp = "none"
[output]
images = "list:2"
error = "none"
[run]
frames = 4
)";

class Shading : public ::testing::Test {
 protected:
  Outcome run(const std::string& name, const std::vector<std::string>& settings) {
    return test::run_session(place_, session, name, settings);
  }
  ImageRgba8 picture(const std::string& name, const char* eye) {
    return read_png(place_ / name / "images" / (std::string("000002_") + eye + ".png"));
  }
  double sum(const std::string& name, const char* column) {
    const std::vector<double> counts = test::csv_column(place_.read(name + "/costs.csv"), column);
    return std::accumulate(counts.begin(), counts.end(), 0.0);
  }
  Workplace place_;
};

int largest_step(const ImageRgba8& a, const ImageRgba8& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const Rgba8 &p = a.pixels[i], &q = b.pixels[i];
    largest = std::max({largest, std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
  }
  return largest;
}

TEST_F(Shading, BothRayCastersShowTheSame) {
  ASSERT_EQ(run("unlit", {}).exit_code, 0);
  for (const std::string shading : {"shadow_ao", "random_lights"}) {
    const std::string lit = "scene.shading=" + shading;
    ASSERT_EQ(run(shading, {lit, "scene.shading_step_voxels=1.5"}).exit_code, 0);
    const Outcome native = run("native", {lit, "scene.shading_step_voxels=1.5", "pipeline.cast=native"});
    ASSERT_EQ(native.exit_code, 0) << native.err;
    for (const char* eye : {"left", "right"}) {
      EXPECT_LE(largest_step(picture(shading, eye), picture("native", eye)), 1) << shading;
      EXPECT_GT(largest_step(picture(shading, eye), picture("unlit", eye)), 20) << shading;
    }
    EXPECT_NEAR(sum("native", "shading_fetches") / sum(shading, "shading_fetches"), 1.0, 1e-3);
  }
}

TEST_F(Shading, ModelsPriceAdditionalSamples) {
  constexpr double price_ns = 0.0269;  // of a shading fetch, gtx-1080
  for (const std::string samples : {"0", "4", "64"})
    ASSERT_EQ(run(samples, {"scene.shading=random_lights", "scene.shading_samples=" + samples}).exit_code, 0);
  EXPECT_EQ(sum("0", "shading_fetches"), 0.0);
  EXPECT_GT(sum("4", "shading_fetches"), 1000.0);
  EXPECT_EQ(sum("64", "shading_fetches"), 16.0 * sum("4", "shading_fetches"));
  EXPECT_EQ(sum("64", "samples"), sum("0", "samples"));
  EXPECT_NEAR(sum("64", "cost_ns") - sum("0", "cost_ns"), price_ns * sum("64", "shading_fetches"), 20.0);
}

TEST_F(Shading, LightComesFromItsSide) {
  const auto brightness = [&](const std::string& light) {
    EXPECT_EQ(run(light, {"scene.shading=shadow_ao", "scene.light=" + light}).exit_code, 0);
    const ImageRgba8 image = picture(light, "left");
    double sum = 0.0;
    for (const Rgba8& pixel : image.pixels)
      sum += pixel.r;
    return sum;
  };
  // From the viewer's side what is seen is lit, from behind it lies in the volume's own shadow.
  EXPECT_GT(brightness("0,0,1"), 1.3 * brightness("0,0,-1"));
}

TEST_F(Shading, WrongSettingsAreRefused) {
  const auto refused = [&](const char* setting) {
    const Outcome outcome = run("wrong", {setting});
    EXPECT_EQ(outcome.exit_code, 2) << setting;
    return outcome.err;
  };
  EXPECT_THAT(refused("scene.shading_samples=65"), HasSubstr("0 to 64"));
  EXPECT_THAT(refused("scene.shading_step_voxels=0"), HasSubstr("0.01 to 64"));
  EXPECT_THAT(refused("scene.shading=random_light"), HasSubstr("random_lights"));
  for (const char* light : {"scene.light=0,0,0", "scene.light=1,2", "scene.light=1,2,3,4", "scene.light=up"})
    EXPECT_THAT(refused(light), HasSubstr("x,y,z"));
}

}  // namespace
}  // namespace brace
