#include "runtime/stereo/layer_count.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr double kLayersMax = 1 << 24;  // more than any picture is wide

int whole_layers(double layers) {
  return static_cast<int>(std::min(layers, kLayersMax));
}

}  // namespace

double disparity_range_px(const StereoOptics& optics, double z_near_m, double z_far_m) {
  BRACE_CHECK(z_near_m > 0.0 && z_far_m >= z_near_m);
  const double at_infinity = optics.eye_distance_m * optics.pixels_per_tangent / z_near_m;
  return std::isinf(z_far_m) ? at_infinity : at_infinity * ((z_far_m - z_near_m) / z_far_m);
}

double disparity_range_of_sphere_px(const StereoOptics& optics, double radius_m, double near_m) {
  BRACE_CHECK(near_m > 0.0 && radius_m >= 0.0);
  return optics.pixels_per_tangent / near_m *
         (2.0 * radius_m * optics.eye_distance_m / (near_m + 2.0 * radius_m));
}

int layer_count(const StereoOptics& optics, double radius_m, double near_m) {
  return whole_layers(std::floor(disparity_range_of_sphere_px(optics, radius_m, near_m)) + 1.0);
}

double near_plane_m(const StereoOptics& optics, double radius_m, double disparity_px) {
  BRACE_CHECK(disparity_px > 0.0 && radius_m >= 0.0);
  // w / tan alpha = 2 pixels_per_tangent.
  const double q = optics.eye_distance_m * radius_m * 2.0 * optics.pixels_per_tangent / disparity_px;
  return q == 0.0 ? 0.0 : q / (radius_m + std::sqrt(radius_m * radius_m + q));
}

int interference_free_layers(double range_px, double pixels_per_ray) {
  BRACE_CHECK(range_px >= 0.0 && pixels_per_ray > 0.0);
  return whole_layers(std::ceil((range_px + 1.0) / pixels_per_ray));
}

std::uint64_t layer_bytes(int width_px, int height_px, int layers, int bytes_per_texel) {
  return static_cast<std::uint64_t>(width_px) * static_cast<std::uint64_t>(height_px) *
         static_cast<std::uint64_t>(layers) * static_cast<std::uint64_t>(bytes_per_texel);
}

}  // namespace brace
