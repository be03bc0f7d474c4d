#include <cmath>

#include <glm/mat3x3.hpp>
#include <gtest/gtest.h>

#include "runtime/replay/headset.hpp"

namespace brace {
namespace {

const std::vector<std::string> axes = {"+x", "-x", "+y", "-y", "+z", "-z"};

glm::dvec3 unit(const std::string& axis) {
  glm::dvec3 v(0.0);
  v[axis[1] - 'x'] = axis[0] == '+' ? 1.0 : -1.0;
  return v;
}

Session::Scene scene_at(const std::string& position, const std::string& up = "+y",
                        const std::string& front = "+z") {
  Session::Scene scene;
  scene.size_m = 0.5;
  scene.position = position;
  scene.up = up;
  scene.front = front;
  return scene;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, const std::string& where) {
  EXPECT_NEAR(glm::length(a - b), 0.0, 1e-12) << where;
}

Pose head_at(const glm::dvec3& position, double yaw_rad, double pitch_rad = 0.0, double roll_rad = 0.0) {
  Pose head;
  head.position = position;
  head.orientation =
      quat_exp({0.0, yaw_rad, 0.0}) * quat_exp({pitch_rad, 0.0, 0.0}) * quat_exp({0.0, 0.0, roll_rad});
  return head;
}

TEST(PlaceVolume, EveryPairOfAxesGivesAProperRotationWithUpUpwardsAndFrontToTheViewer) {
  int pairs = 0;
  for (const std::string& up : axes) {
    for (const std::string& front : axes) {
      if (up[1] == front[1]) continue;
      ++pairs;
      const std::string where = up + " " + front;
      const Pose placed = place_volume(scene_at("1,2,3", up, front), Pose{}).world_from_volume;
      EXPECT_NEAR(glm::length(placed.orientation), 1.0, 1e-12) << where;
      expect_near(placed.orientation * unit(up), {0, 1, 0}, where);
      expect_near(placed.orientation * unit(front), {0, 0, 1}, where);
      expect_near(placed.orientation * glm::cross(unit(up), unit(front)), {1, 0, 0}, where);
      expect_near(placed.position, {1, 2, 3}, where);
    }
  }
  EXPECT_EQ(pairs, 24);
}

TEST(PlaceVolume, FrontStandsAtTheDistanceAtEyeHeightAndFacesTheHead) {
  for (const double yaw : {0.0, 0.5, -2.0, 3.1, M_PI}) {
    for (const double pitch : {0.0, 1.2, -1.5}) {
      for (const double distance : {1.2, 0.01, 30.0}) {
        const Pose head = head_at({0.3, 1.7, -2.0}, yaw, pitch, 0.4);
        const VolumePlacement placement =
            place_volume(scene_at("front:" + std::to_string(distance), "+z", "-y"), head);
        const Pose& placed = placement.world_from_volume;
        const std::string where = "yaw " + std::to_string(yaw) + " pitch " + std::to_string(pitch);
        const glm::dvec3 forward(-std::sin(yaw), 0.0, -std::cos(yaw));
        expect_near(placed.position, head.position + distance * forward, where);
        expect_near(placed.orientation * unit("+z"), {0, 1, 0}, where);
        expect_near(placed.orientation * unit("-y"), -forward, where);
        EXPECT_EQ(placement.size_m, 0.5);
      }
    }
  }
}

TEST(PlaceVolume, AHeadThatLooksStraightUpOrDownTakesTheWorldsHeading) {
  for (const double pitch : {M_PI / 2, -M_PI / 2}) {
    const Pose placed = place_volume(scene_at("front:2"), head_at({0, 1, 0}, 0.0, pitch)).world_from_volume;
    EXPECT_NEAR(glm::length(placed.position - glm::dvec3(0, 1, -2)), 0.0, 1e-9) << pitch;
  }
}

TEST(PlaceVolume, AFixedPositionDoesNotDependOnTheHead) {
  const Pose a = place_volume(scene_at("0.5,1,-2"), Pose{}).world_from_volume;
  const Pose b = place_volume(scene_at("0.5,1,-2"), head_at({4, 5, 6}, 1.0, 0.3)).world_from_volume;
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.orientation, b.orientation);
}

}  // namespace
}  // namespace brace
