#include "runtime/mab/level_map.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace brace {
namespace {

constexpr sim::FovTangents fov{-1.2, 1.0, -1.1, 1.3};

LevelMapInput input_for(const sim::EyeLens& lens) {
  return {
      .lens = lens, .fov = fov, .width_px = 60, .height_px = 50, .panel_width_px = 60, .panel_height_px = 50};
}

float at(const std::vector<float>& x, int column, int row) {
  return x[static_cast<std::size_t>(row * 60 + column)];
}

TEST(LevelMap, RadiusIsTheDistanceFromTheGazePointOverThatOfTheFarthestCorner) {
  const sim::EyeLens lens = sim::identity_lens(fov);
  LevelMapInput input = input_for(lens);
  for (const glm::dvec2 gaze : {glm::dvec2(0.0), glm::dvec2(-1.2, 1.3), glm::dvec2(5.0, 0.0)}) {
    input.gaze_tan = gaze;
    const std::vector<float> x = level_coordinates(LevelMap::radius, input);
    const glm::dvec2 centre = sim::tangents_to_target_uv(fov, gaze) * glm::dvec2(60, 50);
    double reach = 0.0;
    for (const glm::dvec2 corner :
         {glm::dvec2(0, 0), glm::dvec2(60, 0), glm::dvec2(0, 50), glm::dvec2(60, 50)})
      reach = std::max(reach, glm::distance(corner, centre));
    for (int row = 0; row < 50; ++row)
      for (int column = 0; column < 60; ++column)
        ASSERT_NEAR(at(x, column, row), glm::distance({column + 0.5, row + 0.5}, centre) / reach, 1e-6);
  }
}

TEST(LevelMap, WithoutALensEveryPixelIsOfUse) {
  const sim::EyeLens lens = sim::identity_lens(fov);
  for (const float x : level_coordinates(LevelMap::lens, input_for(lens)))
    ASSERT_NEAR(x, 0.0, 1e-6);
}

/// Against differences of the whole mapping, picture to panel.
TEST(LevelMap, LensDemandIsTheLargestStretchOfTheInverseMapping) {
  sim::EyeLens lens = sim::identity_lens(fov);
  lens.kind = sim::LensKind::brown_conrady;
  for (sim::LensChannel& channel : lens.rgb) {
    channel.k = {0.2, 0.1, 0.02, 0, 0};
    channel.centre_uv = {0.5, 0.5};
  }
  lens.panel_size_units = {1.6, 1.6};
  lens.tan_per_unit = {1.4, 1.4};
  LevelMapInput input = input_for(lens);
  input.panel_width_px = 30;  // coarser than the picture, so that nothing is cut off at 1
  input.panel_height_px = 30;
  const double usable = sim::usable_radius(lens, sim::Channel::green);
  const auto panel_px = [&](glm::dvec2 t) {
    return *sim::tangents_to_panel(lens, sim::Channel::green, usable, t) * 30.0;
  };
  for (const glm::dvec2 t : {glm::dvec2(0.1, 0.05), glm::dvec2(0.5, -0.3), glm::dvec2(-0.7, 0.6)}) {
    double largest = 0.0;
    for (int degrees = 0; degrees < 180; ++degrees) {
      const double angle = degrees * 0.017453292519943295;
      const glm::dvec2 step = 1e-4 * glm::dvec2(std::cos(angle), std::sin(angle));
      // Tangents per picture pixel differ by axis; the demand takes the denser one.
      const double pixels = glm::length(step) * std::min(60 / fov.width(), 50 / fov.height());
      largest = std::max(largest, glm::distance(panel_px(t + step), panel_px(t - step)) / (2.0 * pixels));
    }
    EXPECT_NEAR(lens_demand(input, t), largest, 0.01 * largest);
  }
  EXPECT_EQ(lens_demand(input, {50.0, 50.0}), 0.0) << "nothing shows it";
}

TEST(LevelMap, AcuityFallsWithTheAngleFromTheGazePoint) {
  const sim::EyeLens lens = sim::identity_lens(fov);
  LevelMapInput input = input_for(lens);
  input.resolution_scale = 0.05;
  EXPECT_EQ(acuity_demand(input, {0.0, 0.0}), 1.0);
  // 45 degrees off: pitch 1 / sqrt 2, resolution 1/48 + 0.0275 * 45 degrees.
  const double pitch = 0.05 * std::max(fov.width() / 60, fov.height() / 50) / std::sqrt(2.0);
  const double resolved = (1.0 / 48 + 0.0275 * 45) * 0.017453292519943295;
  EXPECT_NEAR(acuity_demand(input, {1.0, 0.0}), pitch / resolved, 1e-9);
  input.gaze_tan = {1.0, 0.0};
  EXPECT_EQ(acuity_demand(input, {1.0, 0.0}), 1.0);
}

TEST(LevelMap, TheProductIsTheProduct) {
  sim::EyeLens lens = sim::identity_lens(fov);
  lens.kind = sim::LensKind::brown_conrady;
  for (sim::LensChannel& channel : lens.rgb)
    channel.k = {0.2, 0.1, 0, 0, 0};
  LevelMapInput input = input_for(lens);
  input.resolution_scale = 0.1;
  const std::vector<float> by_lens = level_coordinates(LevelMap::lens, input);
  const std::vector<float> by_eye = level_coordinates(LevelMap::eccentricity, input);
  const std::vector<float> both = level_coordinates(LevelMap::lens_eccentricity, input);
  for (std::size_t i = 0; i < both.size(); ++i)
    ASSERT_NEAR(1.0 - both[i], (1.0 - by_lens[i]) * (1.0 - by_eye[i]), 1e-6);
}

}  // namespace
}  // namespace brace
