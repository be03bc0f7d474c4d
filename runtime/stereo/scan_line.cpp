#include "runtime/stereo/scan_line.hpp"

#include <algorithm>
#include <cmath>

namespace brace {

namespace {

void blend_behind(glm::dvec4& pixel, const glm::dvec3& colour, double optical_depth) {
  const double opacity = (1.0 - pixel.w) * -std::expm1(-optical_depth);
  pixel += glm::dvec4(colour * opacity, opacity);
}

}  // namespace

std::vector<glm::dvec4> compose_scan_line(const StereoGeometry& geometry, const ScanRow& row, int width_px,
                                          const PathLengths& lengths) {
  std::vector<glm::dvec4> pixels(static_cast<std::size_t>(width_px), glm::dvec4(0.0));
  for (std::size_t ray = row.rays.size(); ray-- > 0;) {
    const double at_infinity =
        geometry.pixels_per_ray * (row.first_column + static_cast<double>(ray) + 0.5) + geometry.shift_px;
    for (const ScanSegment& segment : row.rays[ray]) {
      const double length_m = segment.z_end_m - segment.z_begin_m;
      double z_m = segment.z_begin_m;
      double column = std::floor(at_infinity - geometry.disparity_px_m / z_m);
      while (z_m < segment.z_end_m && column < width_px) {
        // The depth at which the ray leaves the pixel; never, where it lies beyond the point at infinity.
        const double to_border = at_infinity - (column + 1.0);
        const double border_m = to_border > 0.0 ? geometry.disparity_px_m / to_border : segment.z_end_m;
        const double end_m = std::min(std::max(border_m, z_m), segment.z_end_m);
        if (column >= 0.0) {
          const auto pixel = static_cast<std::size_t>(column);
          double depth = segment.optical_depth * ((end_m - z_m) / length_m);
          if (!lengths.per_depth_of_ray.empty())
            depth *= lengths.per_depth_of_column[pixel] / lengths.per_depth_of_ray[ray];
          blend_behind(pixels[pixel], segment.colour, depth);
        }
        z_m = end_m;
        column += 1.0;
      }
    }
  }
  return pixels;
}

}  // namespace brace
