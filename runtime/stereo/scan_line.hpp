#pragma once

#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "runtime/stereo/stereo_geometry.hpp"

// Stereo by re-projection in scan-line order (Adelson and Hansen 1994; He and Kaufman 1996), in double
// precision and without layers: one row of the first eye's rays is processed from right to left, each from
// front to back, and every piece goes straight to the second eye's picture, whose pixels thus receive their
// pieces from front to back. What the layers of a parallel device must come to.
namespace brace {

/// A piece of a ray between two depths (metres along the view direction) with constant extinction.
struct ScanSegment {
  double z_begin_m = 0.0, z_end_m = 0.0;
  glm::dvec3 colour{0.0};      // not premultiplied
  double optical_depth = 0.0;  // to the base e, along the first eye's ray
};

struct ScanRow {
  int first_column = 0;                            // of `rays`, in pixels of the first eye
  std::span<const std::vector<ScanSegment>> rays;  // front to back each
};

/// How a piece's optical depth becomes that of the second eye's ray, which crosses the same depths at another
/// angle: factor = length along the second eye's ray / length along the first's. Empty: 1, as published.
struct PathLengths {
  std::vector<double> per_depth_of_ray;     // length per depth of the first eye's rays, by index in rays
  std::vector<double> per_depth_of_column;  // … of the second eye's pixels
};

/// A row of the second eye's picture, premultiplied. A piece that crosses pixel borders is cut at them, its
/// optical depth in proportion to depth.
std::vector<glm::dvec4> compose_scan_line(const StereoGeometry& geometry, const ScanRow& row, int width_px,
                                          const PathLengths& lengths = {});

}  // namespace brace
