#pragma once

#include "runtime/raycast/eye_view.hpp"
#include "runtime/stereo/layer_count.hpp"

namespace brace {

/// How the first eye's rays fall on the second eye's picture. Both look the same way from places beside each
/// other; a point at depth z (metres along the view direction) on the first eye's ray of column x + 1/2 falls
/// on
///   column  pixels_per_ray (x + 1/2) + shift_px - disparity_px_m / z
/// of the second (eq. 15 in pixels, with the eyes' own frusta), and row y + 1/2 of the second eye on
///   row     rows_per_row (y + 1/2) + row_shift
/// of the first.
struct StereoGeometry {
  double pixels_per_ray = 1.0;
  double shift_px = 0.0;
  double disparity_px_m = 0.0;
  double rows_per_row = 1.0;
  double row_shift = 0.0;
  StereoOptics optics;

  /// Where a point at depth `z_m` on the ray through column x falls, in pixels from the left edge.
  double column(double x, double z_m) const { return pixels_per_ray * x + shift_px - disparity_px_m / z_m; }
};

/// Both eyes of a frame.
struct EyeViews {
  EyeView left, right;
};

/// Both as a mirror shows them: an eye to the left of the other is to its right then.
EyeViews mirrored(const EyeViews& pair);

/// Whether a shift along the rows takes one eye's picture to the other's: neither is turned against the
/// other, above or behind it. Otherwise rectify() finds planes where that is so.
bool are_coplanar(const EyeViews& eyes);

/// Throws input_error for eyes that are not coplanar, a right eye to the left of the other, and pictures of
/// different size.
StereoGeometry stereo_geometry(const EyeView& left, const EyeView& right);

/// The depths in metres between which a placed volume lies before an eye; `near_m` <= 0: the eye's plane
/// meets it, `far_m` <= 0: it lies behind.
struct DepthRange {
  double near_m = 0.0, far_m = 0.0;
};
DepthRange depth_range(const EyeView& eye, const VolumeInfo& volume, const VolumePlacement& placement);

/// Half the box's diagonal.
double bounding_radius_m(const VolumeInfo& volume, const VolumePlacement& placement);

/// Rays beside the first eye's picture that the second eye sees content of.
struct RayMargins {
  int left = 0, right = 0, top = 0, bottom = 0;
};
RayMargins ray_margins(const StereoGeometry& geometry, int width_px, int height_px, DepthRange depths);

}  // namespace brace
