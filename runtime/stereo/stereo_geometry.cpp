#include "runtime/stereo/stereo_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"

namespace brace {

namespace {

/// Above rounding of a profile's figures, below what a pixel of any display would show.
constexpr double kParallel_rad = 1e-5;
constexpr double kBeside_m = 1e-5;

int margin(double rays) {
  return static_cast<int>(std::clamp(std::ceil(rays), 0.0, 65536.0));
}

}  // namespace

EyeViews mirrored(const EyeViews& pair) {
  EyeViews in_mirror = pair;
  for (EyeView* eye : {&in_mirror.left, &in_mirror.right}) {
    const double tan_left = eye->tan_left;
    eye->tan_left = -eye->tan_right;
    eye->tan_right = -tan_left;
  }
  const Pose apart = compose(inverse(pair.left.world_from_eye), pair.right.world_from_eye);
  const glm::dquat& q = apart.orientation;
  in_mirror.left.world_from_eye = Pose{};
  in_mirror.right.world_from_eye = {glm::dquat(q.w, q.x, -q.y, -q.z),
                                    {-apart.position.x, apart.position.y, apart.position.z}};
  return in_mirror;
}

bool are_coplanar(const EyeViews& eyes) {
  const glm::dvec3 apart_m = compose(inverse(eyes.left.world_from_eye), eyes.right.world_from_eye).position;
  return angle_between_rad(eyes.left.world_from_eye.orientation, eyes.right.world_from_eye.orientation) <=
             kParallel_rad &&
         std::abs(apart_m.y) <= kBeside_m && std::abs(apart_m.z) <= kBeside_m;
}

StereoGeometry stereo_geometry(const EyeView& left, const EyeView& right) {
  const Pose left_from_right = compose(inverse(left.world_from_eye), right.world_from_eye);
  const double cant_rad =
      angle_between_rad(left.world_from_eye.orientation, right.world_from_eye.orientation);
  if (cant_rad > kParallel_rad) {
    throw input_error(
        "stage stereo/layers: the eyes' planes are canted by {:.3f} degrees, so no shift along the rows "
        "takes "
        "one "
        "eye's picture to the other's; accepted: those that rectify() gives, or stereo/two_pass",
        glm::degrees(cant_rad));
  }
  const glm::dvec3 apart = left_from_right.position;
  if (apart.x < 0.0 || std::abs(apart.y) > kBeside_m || std::abs(apart.z) > kBeside_m) {
    throw input_error(
        "stage stereo/layers: the right eye is at ({}, {}, {}) m from the left; accepted: to its right alone "
        "(otherwise stereo/two_pass)",
        apart.x, apart.y, apart.z);
  }
  if (left.width_px != right.width_px || left.height_px != right.height_px) {
    throw input_error("stage stereo/layers: the eyes' pictures have different sizes; accepted: equal ones");
  }
  const auto per_tangent = [](int pixels, double low, double high) { return pixels / (high - low); };
  const double left_x = per_tangent(left.width_px, left.tan_left, left.tan_right);
  const double right_x = per_tangent(right.width_px, right.tan_left, right.tan_right);
  const double left_y = per_tangent(left.height_px, left.tan_bottom, left.tan_top);
  const double right_y = per_tangent(right.height_px, right.tan_bottom, right.tan_top);
  StereoGeometry geometry;
  geometry.pixels_per_ray = right_x / left_x;
  geometry.shift_px = (left.tan_left - right.tan_left) * right_x;
  geometry.disparity_px_m = apart.x * right_x;
  geometry.rows_per_row = left_y / right_y;
  geometry.row_shift = (left.tan_top - right.tan_top) * left_y;
  geometry.optics = {apart.x, right_x};
  return geometry;
}

DepthRange depth_range(const EyeView& eye, const VolumeInfo& volume, const VolumePlacement& placement) {
  const auto box = box_size(volume);
  const double scale = placement.size_m / *std::max_element(box.begin(), box.end());
  const Pose eye_from_volume = compose(inverse(eye.world_from_eye), placement.world_from_volume);
  DepthRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 at;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = ((corner >> axis & 1) != 0 ? 0.5 : -0.5) * scale * box[static_cast<std::size_t>(axis)];
    const double depth_m = -transform_point(eye_from_volume, at).z;
    range.near_m = std::min(range.near_m, depth_m);
    range.far_m = std::max(range.far_m, depth_m);
  }
  return range;
}

double bounding_radius_m(const VolumeInfo& volume, const VolumePlacement& placement) {
  const auto box = box_size(volume);
  const double scale = placement.size_m / *std::max_element(box.begin(), box.end());
  return 0.5 * scale * std::hypot(box[0], box[1], box[2]);
}

RayMargins ray_margins(const StereoGeometry& geometry, int width_px, int height_px, DepthRange depths) {
  BRACE_CHECK(depths.near_m > 0.0 && depths.far_m >= depths.near_m);
  const auto ray = [&](double column, double z_m) {
    return (column - geometry.shift_px + geometry.disparity_px_m / z_m) / geometry.pixels_per_ray;
  };
  const auto row = [&](double y) { return geometry.rows_per_row * y + geometry.row_shift; };
  // Half a row more: a row between two rays is composed of both.
  return {margin(-ray(0.0, depths.far_m)), margin(ray(width_px, depths.near_m) - width_px),
          margin(-row(0.5) + 0.5), margin(row(height_px - 0.5) + 0.5 - height_px)};
}

}  // namespace brace
