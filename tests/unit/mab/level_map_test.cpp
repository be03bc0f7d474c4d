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
    const std::vector<float> x = level_coordinates(LevelMap::radius, input).x;
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
  const LevelCoordinates map = level_coordinates(LevelMap::lens, input_for(lens));
  EXPECT_NEAR(map.demand_of_rank.front(), 1.0, 1e-3);
  EXPECT_GE(map.coordinate_of(0.98), *std::max_element(map.x.begin(), map.x.end())) << "no pixel has less";
  // All demands are equal: the radial map.
  const LevelCoordinates radial = level_coordinates(LevelMap::radius, input_for(lens));
  for (std::size_t i = 0; i < map.x.size(); ++i)
    ASSERT_NEAR(map.x[i], radial.x[i], 1e-6);
}

/// What is capped is equal: where the lens asks for more than a ray per pixel, the radial map as well.
TEST(LevelMap, DemandBeyondTheFinestLevelIsOfNoUse) {
  sim::EyeLens lens = sim::identity_lens(fov);
  lens.kind = sim::LensKind::brown_conrady;
  for (sim::LensChannel& channel : lens.rgb)
    channel.k = {-0.03, 0, 0, 0, 0};  // denser towards the rim
  LevelMapInput input = input_for(lens);
  input.panel_width_px = input.panel_height_px = 200;
  input.demand_cap = 1.0;
  const LevelCoordinates map = level_coordinates(LevelMap::lens, input);
  const LevelCoordinates radial = level_coordinates(LevelMap::radius, input);
  for (std::size_t i = 0; i < map.x.size(); ++i)
    ASSERT_NEAR(map.x[i], radial.x[i], 0.02);
}

TEST(LevelMap, CoordinatesOfDemandAreTheRadialOnesInItsOrder) {
  sim::EyeLens lens = sim::identity_lens(fov);
  lens.kind = sim::LensKind::brown_conrady;
  for (sim::LensChannel& channel : lens.rgb)
    channel.k = {0.2, 0.1, 0, 0, 0};
  const LevelMapInput input = input_for(lens);
  const LevelCoordinates map = level_coordinates(LevelMap::lens_eccentricity, input);
  std::vector<float> sorted = map.x, radii = level_coordinates(LevelMap::radius, input).x;
  std::sort(sorted.begin(), sorted.end());
  std::sort(radii.begin(), radii.end());
  for (std::size_t i = 0; i < sorted.size() && sorted[i] < 1.0f; ++i)
    ASSERT_NEAR(sorted[i], radii[i], 0.03) << i;
  for (int row = 5; row < 50; row += 20)
    for (int column = 1; column < 60; column += 3) {
      const auto demand = [&](int x) {
        const glm::dvec2 t = sim::target_uv_to_tangents(fov, {(x + 0.5) / 60, (row + 0.5) / 50});
        return lens_demand(input, t) * acuity_demand(input, t);
      };
      if (demand(column - 1) > 1.03 * demand(column)) {
        ASSERT_LE(at(map.x, column - 1, row), at(map.x, column, row));
      }
    }
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
  input.width_px = 55;  // 25 pixels per tangent both ways
  input.height_px = 60;
  input.panel_width_px = input.panel_height_px = 60;
  const double usable = sim::usable_radius(lens, sim::Channel::green);
  const auto panel_px = [&](glm::dvec2 t) {
    return *sim::tangents_to_panel(lens, sim::Channel::green, usable, t) * 60.0;
  };
  for (const glm::dvec2 t : {glm::dvec2(0.1, 0.05), glm::dvec2(0.5, -0.3), glm::dvec2(-0.7, 0.6)}) {
    double largest = 0.0;
    for (int degrees = 0; degrees < 180; ++degrees) {
      const double angle = degrees * 0.017453292519943295;
      const glm::dvec2 step = 1e-4 * glm::dvec2(std::cos(angle), std::sin(angle));
      const double pixels = glm::length(step) * 25.0;
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
  // 45 degrees off: pitch 1 / sqrt 2, resolution 1/48 + 0.0275 * 45 degrees.
  const double pitch = 0.05 * std::max(fov.width() / 60, fov.height() / 50) / std::sqrt(2.0);
  const double resolved = (1.0 / 48 + 0.0275 * 45) * 0.017453292519943295;
  EXPECT_NEAR(acuity_demand(input, {1.0, 0.0}), pitch / resolved, 1e-9);
  input.gaze_tan = {1.0, 0.0};
  EXPECT_NEAR(acuity_demand(input, {1.0, 0.0}), pitch / (0.017453292519943295 / 48), 1e-9);
}

TEST(LevelMap, TheProductIsTheProduct) {
  sim::EyeLens lens = sim::identity_lens(fov);
  lens.kind = sim::LensKind::brown_conrady;
  for (sim::LensChannel& channel : lens.rgb)
    channel.k = {0.2, 0.1, 0, 0, 0};
  LevelMapInput input = input_for(lens);
  input.resolution_scale = 0.1;
  const LevelCoordinates both = level_coordinates(LevelMap::lens_eccentricity, input);
  for (int row = 0; row < 50; ++row)
    for (int column = 0; column < 60; ++column) {
      const glm::dvec2 t = sim::target_uv_to_tangents(fov, {(column + 0.5) / 60, (row + 0.5) / 50});
      // Between what has as much demand and what has up to 1 % less, which tells equal ones apart.
      const double demand = lens_demand(input, t) * acuity_demand(input, t);
      ASSERT_GE(at(both.x, column, row), both.coordinate_of(demand) - 1e-6);
      ASSERT_LE(at(both.x, column, row), both.coordinate_of(0.99 * demand) + 1e-6);
    }
}

TEST(LevelMap, CoordinatesStayBetween0And1) {
  const LevelCoordinates map{{}, 0.25, {4.0, 2.0, 1.0}, {0.125f, 0.5f, 0.875f}};
  EXPECT_EQ(map.coordinate_of(4.0), 0.0);
  EXPECT_EQ(map.coordinate_of(3.0), 0.125);
  EXPECT_EQ(map.coordinate_of(1.0), 0.5);
  EXPECT_EQ(map.coordinate_of(0.5), 0.875);
  EXPECT_EQ(map.coordinate_of(0.25), 1.0);
  for (const double nothing : {0.0, -1.0, std::nan("")})
    EXPECT_EQ(map.coordinate_of(nothing), 1.0);
  EXPECT_EQ(map.coordinate_of(1e300), 0.0);
}

}  // namespace
}  // namespace brace
