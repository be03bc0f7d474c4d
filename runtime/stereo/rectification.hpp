#pragma once

#include <array>
#include <optional>
#include <string>

#include "runtime/stereo/stereo_geometry.hpp"

namespace brace {

/// Planes on which eyes whose own are not coplanar (canted displays) have their pictures first: both parallel
/// to the line between the eyes, so that a shift along the rows takes one to the other (Fusiello et al.
/// 2000). Fixed to the head.
struct Rectification {
  struct Frustum {
    double tan_left, tan_right, tan_bottom, tan_top;  // of the planes' frame; holds the eye's own
  };
  glm::dquat left_from_planes{1.0, 0.0, 0.0, 0.0};  // directions, from the left eye's frame
  std::array<Frustum, 2> frusta{};                  // left, right
  int width_px = 0, height_px = 0;                  // of both; as fine as the eyes' own straight ahead
  double turned_rad = 0.0;                          // by how much the eye that is turned more

  /// The eyes of a frame on these planes, where they are.
  EyeViews apply(const EyeViews& eyes) const;
  /// For the report.
  std::string summary() const;
};

/// Nothing where a shift along the rows takes one eye to the other already. Throws input_error where no such
/// planes show what both eyes see: the right eye to the left of the other, eyes that look apart too far.
std::optional<Rectification> rectify(const EyeViews& eyes);

}  // namespace brace
