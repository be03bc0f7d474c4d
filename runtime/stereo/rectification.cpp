#include "runtime/stereo/rectification.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/error.hpp"

namespace brace {

namespace {

/// Depth per length of a direction that a plane still shows: 84 degrees off.
constexpr double kCosMin = 0.1;
constexpr double kApart_m = 1e-6;  // nearer than that, eyes are in one place

using Corners = std::array<glm::dvec2, 4>;

Corners corners_of(const EyeView& eye) {
  return {glm::dvec2(eye.tan_left, eye.tan_bottom), glm::dvec2(eye.tan_left, eye.tan_top),
          glm::dvec2(eye.tan_right, eye.tan_bottom), glm::dvec2(eye.tan_right, eye.tan_top)};
}

glm::dquat planes_from(const EyeView& eye, const glm::dquat& world_from_planes) {
  return glm::conjugate(world_from_planes) * eye.world_from_eye.orientation;
}

/// Where a direction given by an eye's tangents is on the planes.
glm::dvec2 on_planes(const glm::dquat& planes_from_eye, glm::dvec2 tangents) {
  const glm::dvec3 at = planes_from_eye * glm::normalize(glm::dvec3(tangents, -1.0));
  if (!(-at.z > kCosMin)) {
    throw input_error(
        "stage stereo/layers: no plane along the line between the eyes shows what both see; accepted: "
        "stereo/novel_view, stereo/two_pass");
  }
  return glm::dvec2(at) / -at.z;
}

/// The planes' frame: x along the eyes' line, z as near to the eyes' own as that allows.
glm::dquat world_from_planes_of(const EyeViews& eyes) {
  const glm::dquat& left = eyes.left.world_from_eye.orientation;
  const glm::dquat& right = eyes.right.world_from_eye.orientation;
  const glm::dvec3 mean_x = glm::normalize(left * glm::dvec3(1, 0, 0) + right * glm::dvec3(1, 0, 0));
  const glm::dvec3 mean_z = left * glm::dvec3(0, 0, 1) + right * glm::dvec3(0, 0, 1);
  const glm::dvec3 apart_m = eyes.right.world_from_eye.position - eyes.left.world_from_eye.position;
  const bool together = glm::length(apart_m) < kApart_m;
  if (!together && glm::dot(apart_m, mean_x) <= 0.5 * glm::length(apart_m)) {
    throw input_error(
        "stage stereo/layers: the right eye is at ({:.4g}, {:.4g}, {:.4g}) m from the left; accepted: to its "
        "right (otherwise stereo/two_pass)",
        apart_m.x, apart_m.y, apart_m.z);
  }
  const glm::dvec3 x = together ? mean_x : glm::normalize(apart_m);
  const glm::dvec3 z = glm::normalize(mean_z - glm::dot(mean_z, x) * x);
  return glm::quat_cast(glm::dmat3(x, glm::cross(z, x), z));
}

/// What an eye's pixel straight ahead, or as near to that as its picture goes, measures on the planes.
glm::dvec2 pitch_on_planes(const EyeView& eye, const glm::dquat& planes_from_eye) {
  const glm::dvec2 pitch((eye.tan_right - eye.tan_left) / eye.width_px,
                         (eye.tan_top - eye.tan_bottom) / eye.height_px);
  const glm::dvec2 at(std::clamp(0.0, eye.tan_left, eye.tan_right),
                      std::clamp(0.0, eye.tan_bottom, eye.tan_top));
  const auto step = [&](glm::dvec2 by) {
    return on_planes(planes_from_eye, at + 0.5 * by) - on_planes(planes_from_eye, at - 0.5 * by);
  };
  return {glm::length(step({pitch.x, 0.0})), glm::length(step({0.0, pitch.y}))};
}

Rectification::Frustum frustum_on_planes(const EyeView& eye, const glm::dquat& planes_from_eye) {
  Rectification::Frustum frustum{1e9, -1e9, 1e9, -1e9};
  // Straight edges stay straight: the corners are the outermost.
  for (const glm::dvec2& corner : corners_of(eye)) {
    const glm::dvec2 at = on_planes(planes_from_eye, corner);
    frustum.tan_left = std::min(frustum.tan_left, at.x);
    frustum.tan_right = std::max(frustum.tan_right, at.x);
    frustum.tan_bottom = std::min(frustum.tan_bottom, at.y);
    frustum.tan_top = std::max(frustum.tan_top, at.y);
  }
  return frustum;
}

EyeView on_frustum(const EyeView& eye, const Rectification& planes, std::size_t which,
                   const glm::dquat& world_from_planes) {
  const Rectification::Frustum& frustum = planes.frusta[which];
  EyeView view = eye;
  view.world_from_eye.orientation = world_from_planes;
  view.tan_left = frustum.tan_left;
  view.tan_right = frustum.tan_right;
  view.tan_bottom = frustum.tan_bottom;
  view.tan_top = frustum.tan_top;
  view.width_px = planes.width_px;
  view.height_px = planes.height_px;
  return view;
}

}  // namespace

std::optional<Rectification> rectify(const EyeViews& eyes) {
  if (are_coplanar(eyes)) return {};
  const glm::dquat world_from_planes = world_from_planes_of(eyes);
  Rectification planes;
  planes.left_from_planes = glm::conjugate(eyes.left.world_from_eye.orientation) * world_from_planes;
  glm::dvec2 pitch(1e9), size(0.0);
  const std::array<const EyeView*, 2> both = {&eyes.left, &eyes.right};
  for (std::size_t i = 0; i < 2; ++i) {
    const glm::dquat planes_from_eye = planes_from(*both[i], world_from_planes);
    planes.turned_rad = std::max(planes.turned_rad,
                                 angle_between_rad(both[i]->world_from_eye.orientation, world_from_planes));
    pitch = glm::min(pitch, pitch_on_planes(*both[i], planes_from_eye));
    planes.frusta[i] = frustum_on_planes(*both[i], planes_from_eye);
    size = glm::max(size, glm::dvec2(planes.frusta[i].tan_right - planes.frusta[i].tan_left,
                                     planes.frusta[i].tan_top - planes.frusta[i].tan_bottom));
  }
  planes.width_px = static_cast<int>(std::ceil(size.x / pitch.x - 1e-6));
  planes.height_px = static_cast<int>(std::ceil(size.y / pitch.y - 1e-6));
  for (Rectification::Frustum& frustum : planes.frusta) {
    frustum.tan_right = frustum.tan_left + planes.width_px * pitch.x;
    frustum.tan_bottom = frustum.tan_top - planes.height_px * pitch.y;
  }
  return planes;
}

EyeViews Rectification::apply(const EyeViews& eyes) const {
  const glm::dquat world_from_planes = eyes.left.world_from_eye.orientation * left_from_planes;
  return {on_frustum(eyes.left, *this, 0, world_from_planes),
          on_frustum(eyes.right, *this, 1, world_from_planes)};
}

std::string Rectification::summary() const {
  return fmt::format(
      "rectified first: the displays are not coplanar (up to {:.3g} degrees off), so both eyes' pictures are "
      "made on planes along the line between the eyes, {} x {} px, and resampled to the displays'",
      glm::degrees(turned_rad), width_px, height_px);
}

}  // namespace brace
