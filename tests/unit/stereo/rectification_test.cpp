// Planes on which a shift along the rows takes one eye's picture to the other's, for canted displays.
#include "runtime/stereo/rectification.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;

EyeView canted_eye(double x_m, const glm::dvec3& turn_rad) {
  EyeView eye;
  eye.world_from_eye.position = {x_m, 0.0, 0.0};
  eye.world_from_eye.orientation = quat_exp(turn_rad);
  eye.tan_left = -1.4;
  eye.tan_right = 1.1;
  eye.tan_bottom = -1.2;
  eye.tan_top = 1.3;
  eye.width_px = 250;
  eye.height_px = 250;
  return eye;
}

EyeViews canted(double cant_deg, double pitch_deg = 0.0) {
  EyeViews eyes{canted_eye(-0.03, {0.0, cant_deg * kDegree, 0.0}),
                canted_eye(0.03, {pitch_deg * kDegree, -cant_deg * kDegree, 0.0})};
  eyes.right.tan_left = -1.1;
  eyes.right.tan_right = 1.4;
  return eyes;
}

/// Pixel of a point given in the world, by the eye's own projection.
glm::dvec2 pixel_of(const EyeView& eye, const glm::dvec3& point_m) {
  const glm::dvec3 at = transform_point(inverse(eye.world_from_eye), point_m);
  return {(at.x / -at.z - eye.tan_left) / (eye.tan_right - eye.tan_left) * eye.width_px,
          (eye.tan_top - at.y / -at.z) / (eye.tan_top - eye.tan_bottom) * eye.height_px};
}

TEST(Rectification, CoplanarEyesNeedNone) {
  EXPECT_FALSE(rectify(canted(0.0)).has_value());
}

TEST(Rectification, APointFallsOnTheRowAndColumnThatTheGeometrySays) {
  // A head turned anyhow; displays canted, pitched against each other, one of the eyes farther ahead.
  for (const auto& [cant_deg, pitch_deg, ahead_m] :
       {std::array{5.0, 0.0, 0.0}, std::array{10.0, 2.0, 0.0}, std::array{0.0, 0.0, 0.01}}) {
    EyeViews eyes = canted(cant_deg, pitch_deg);
    eyes.right.world_from_eye.position.z -= ahead_m;
    const std::optional<Rectification> planes = rectify(eyes);
    ASSERT_TRUE(planes.has_value());
    const Pose head{quat_exp({0.3, -1.0, 0.5}), {1.0, 2.0, 3.0}};
    eyes.left.world_from_eye = compose(head, eyes.left.world_from_eye);
    eyes.right.world_from_eye = compose(head, eyes.right.world_from_eye);
    const EyeViews on = planes->apply(eyes);
    EXPECT_TRUE(are_coplanar(on));
    const StereoGeometry geometry = stereo_geometry(on.left, on.right);
    for (const glm::dvec3& ahead : {glm::dvec3(0.1, 0.2, -0.7), glm::dvec3(-0.4, -0.1, -1.5)}) {
      const glm::dvec3 point_m = transform_point(head, ahead);
      const glm::dvec2 left = pixel_of(on.left, point_m), right = pixel_of(on.right, point_m);
      const double depth_m = -transform_point(inverse(on.left.world_from_eye), point_m).z;
      EXPECT_NEAR(geometry.column(left.x, depth_m), right.x, 1e-9);
      EXPECT_NEAR(geometry.rows_per_row * right.y + geometry.row_shift, left.y, 1e-9);
    }
  }
}

TEST(Rectification, PlanesShowAllOfBothEyesAsFineAsTheyDoStraightAhead) {
  const EyeViews eyes = canted(5.0);
  const Rectification planes = rectify(eyes).value();
  EXPECT_NEAR(planes.turned_rad, 5.0 * kDegree, 1e-12);
  const EyeViews on = planes.apply(eyes);
  for (const auto& [eye, plane] : {std::pair(eyes.left, on.left), std::pair(eyes.right, on.right)}) {
    const auto on_plane = [&eye = eye, &plane = plane](double x, double y) {
      return pixel_of(plane,
                      eye.world_from_eye.position + eye.world_from_eye.orientation * glm::dvec3(x, y, -1));
    };
    for (const double x : {eye.tan_left, eye.tan_right})
      for (const double y : {eye.tan_bottom, eye.tan_top}) {
        const glm::dvec2 at = on_plane(x, y);
        EXPECT_TRUE(at.x >= -1e-6 && at.y >= -1e-6 && at.x <= plane.width_px + 1e-6 &&
                    at.y <= plane.height_px + 1e-6)
            << at.x << " " << at.y;
      }
    EXPECT_GE(glm::distance(on_plane(0.0, 0.0), on_plane(0.01, 0.0)), 0.999);  // a pixel of the eye's own
    EXPECT_GE(glm::distance(on_plane(0.0, 0.0), on_plane(0.0, 0.01)), 0.999);
  }
  EXPECT_THAT(planes.summary(), HasSubstr("rectified first"));
}

TEST(Rectification, EyesInOnePlaceKeepTheirMeanDirection) {
  EyeViews eyes = canted(5.0);
  eyes.right.world_from_eye.position = eyes.left.world_from_eye.position;
  const Rectification planes = rectify(eyes).value();
  EXPECT_EQ(stereo_geometry(planes.apply(eyes).left, planes.apply(eyes).right).disparity_px_m, 0.0);
}

TEST(Rectification, WhatNoPlaneShowsIsRefused) {
  const auto message_of = [](const EyeViews& eyes) -> std::string {
    try {
      (void)rectify(eyes);
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(message_of(canted(60.0)), HasSubstr("no plane"));
  EyeViews crossed = canted(5.0);
  std::swap(crossed.left.world_from_eye.position, crossed.right.world_from_eye.position);
  EXPECT_THAT(message_of(crossed), HasSubstr("accepted: to its right"));
}

}  // namespace
}  // namespace brace
