#include "runtime/stereo/scan_line.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace brace {
namespace {

constexpr int kWidth_px = 64;
constexpr double kNear_m = 0.5, kFar_m = 1.25;

StereoGeometry geometry_with(double eye_distance_m) {
  const double per_tangent = kWidth_px / 2.0;  // tangents -1 … 1 in both eyes
  StereoGeometry geometry;
  geometry.disparity_px_m = eye_distance_m * per_tangent;
  geometry.optics = {eye_distance_m, per_tangent};
  return geometry;
}

double tangent(double column) {
  return column / (kWidth_px / 2.0) - 1.0;
}

/// A homogeneous slab between two depths; every ray is one segment. Rays beside the picture too.
std::vector<std::vector<ScanSegment>> slab(int first, int count, double extinction_per_m) {
  std::vector<std::vector<ScanSegment>> rays;
  for (int i = 0; i < count; ++i) {
    const double along = std::hypot(1.0, tangent(first + i + 0.5));
    rays.push_back({{kNear_m, kFar_m, {1.0, 0.5, 0.25}, extinction_per_m * (kFar_m - kNear_m) * along}});
  }
  return rays;
}

PathLengths lengths(int first, int count) {
  PathLengths to;
  for (int i = 0; i < count; ++i)
    to.per_depth_of_ray.push_back(std::hypot(1.0, tangent(first + i + 0.5)));
  for (int x = 0; x < kWidth_px; ++x)
    to.per_depth_of_column.push_back(std::hypot(1.0, tangent(x + 0.5)));
  return to;
}

TEST(ScanLine, HomogeneousSlabIsExactWithTheSecondEyesPathLengths) {
  const StereoGeometry geometry = geometry_with(0.065);
  for (const double extinction_per_m : {1e-12, 0.3, 4.0, 1e12}) {
    const auto rays = slab(-8, kWidth_px + 16, extinction_per_m);
    const auto row = compose_scan_line(geometry, {-8, rays}, kWidth_px, lengths(-8, kWidth_px + 16));
    for (int x = 0; x < kWidth_px; ++x) {
      const double path_m = (kFar_m - kNear_m) * std::hypot(1.0, tangent(x + 0.5));
      const double opacity = -std::expm1(-extinction_per_m * path_m);
      EXPECT_NEAR(row[static_cast<std::size_t>(x)].w / opacity, 1.0, 1e-9) << x;
      EXPECT_NEAR(row[static_cast<std::size_t>(x)].y / opacity, 0.5, 1e-9) << x;
    }
  }
}

TEST(ScanLine, AsPublishedTheSlabIsOffByTheAnglesOfTheRays) {
  const auto rays = slab(-8, kWidth_px + 16, 0.3);
  const auto row = compose_scan_line(geometry_with(0.065), {-8, rays}, kWidth_px);
  const double own = -std::expm1(-0.3 * (kFar_m - kNear_m) * std::hypot(1.0, tangent(kWidth_px - 0.5)));
  EXPECT_GT(std::abs(row.back().w - own), 1e-3);
}

TEST(ScanLine, EyesInOnePlaceSeeTheSame) {
  const auto rays = slab(0, kWidth_px, 2.0);
  const auto row = compose_scan_line(geometry_with(0.0), {0, rays}, kWidth_px);
  for (int x = 0; x < kWidth_px; ++x) {
    const double depth = rays[static_cast<std::size_t>(x)].front().optical_depth;
    EXPECT_NEAR(row[static_cast<std::size_t>(x)].w, -std::expm1(-depth), 1e-14);
  }
}

TEST(ScanLine, NearerThingsHideFartherOnes) {
  // A red wall at 0.5 m on the left half of the rays, a green one at 1 m on all.
  std::vector<std::vector<ScanSegment>> rays(kWidth_px);
  for (int i = 0; i < kWidth_px; ++i) {
    auto& ray = rays[static_cast<std::size_t>(i)];
    if (i < kWidth_px / 2) ray.push_back({0.5, 0.501, {1.0, 0.0, 0.0}, 50.0});
    ray.push_back({1.0, 1.001, {0.0, 1.0, 0.0}, 50.0});
  }
  const StereoGeometry geometry = geometry_with(0.065);
  const auto row = compose_scan_line(geometry, {0, rays}, kWidth_px);
  const int edge = static_cast<int>(geometry.column(kWidth_px / 2.0, 0.5));
  EXPECT_GT(row[static_cast<std::size_t>(edge - 2)].x, 0.99);
  EXPECT_GT(row[static_cast<std::size_t>(edge + 2)].y, 0.99);
  EXPECT_LT(row[static_cast<std::size_t>(edge + 2)].x, 1e-6);
}

}  // namespace
}  // namespace brace
