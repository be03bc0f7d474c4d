#include "runtime/stereo/layer_count.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace brace {
namespace {

/// The source's example: 768 px, 110 degrees, eyes 65 mm apart, a volume of radius 1 m.
StereoOptics example() {
  return {0.065, 768.0 / (2.0 * std::tan(55.0 * M_PI / 180.0))};
}

TEST(LayerCount, NearPlaneOfTheSourcesExampleAsItsFormulaGivesIt) {
  EXPECT_NEAR(near_plane_m(example(), 1.0, 32.0), 0.4465, 5e-5);
  EXPECT_NEAR(near_plane_m(example(), 1.0, 33.0), 0.4350, 5e-5);
}

TEST(LayerCount, DisparitiesFromZeroToThirtyTwoNeedThirtyThreeLayers) {
  const double near_m = near_plane_m(example(), 1.0, 32.0);
  EXPECT_EQ(layer_count(example(), 1.0, near_m * (1.0 - 1e-9)), 33);
  EXPECT_EQ(layer_count(example(), 1.0, near_m * (1.0 + 1e-9)), 32);
}

TEST(LayerCount, NearPlaneAndDisparityAreInverses) {
  for (const double radius_m : {1e-9, 1e-3, 0.5, 1e3, 1e9}) {
    for (const double disparity_px : {1e-6, 1.0, 31.0, 1e4}) {
      const double near_m = near_plane_m(example(), radius_m, disparity_px);
      EXPECT_NEAR(disparity_range_of_sphere_px(example(), radius_m, near_m) / disparity_px, 1.0, 1e-12)
          << radius_m << " " << disparity_px;
    }
  }
}

TEST(LayerCount, RangeOfASphereIsTheRangeBetweenItsDepths) {
  EXPECT_NEAR(disparity_range_of_sphere_px(example(), 0.4, 0.7), disparity_range_px(example(), 0.7, 1.5),
              1e-12);
  EXPECT_NEAR(disparity_range_px(example(), 0.5, std::numeric_limits<double>::infinity()),
              example().eye_distance_m * example().pixels_per_tangent / 0.5, 1e-12);
}

TEST(LayerCount, EyesInOnePlaceNeedOneLayerAndNoNearPlane) {
  EXPECT_EQ(layer_count({0.0, 300.0}, 1.0, 0.1), 1);
  EXPECT_EQ(near_plane_m({0.0, 300.0}, 1.0, 32.0), 0.0);
}

TEST(LayerCount, NoTwoRaysThatShareALayerShareAPixel) {
  for (const double pixels_per_ray : {0.97, 1.0, 1.03}) {
    for (const double range_px : {0.0, 0.3, 1.0, 6.999}) {
      const int layers = interference_free_layers(range_px, pixels_per_ray);
      for (double phase = 0.0; phase < 1.0; phase += 0.01) {
        const double last = std::floor(phase + range_px);
        EXPECT_GT(std::floor(phase + layers * pixels_per_ray), last);
      }
    }
  }
}

TEST(LayerCount, MemoryIsThatOfTheSourcesTable) {
  EXPECT_EQ(layer_bytes(512, 512, 32, 8), 64ull << 20);
  EXPECT_EQ(layer_bytes(768, 768, 96, 8), 432ull << 20);
  EXPECT_NEAR(static_cast<double>(layer_bytes(1080, 1080, 64, 8)) / (1 << 20), 569.53, 0.005);
  EXPECT_NEAR(static_cast<double>(layer_bytes(1512, 1512, 96, 8)) / (1 << 20), 1674.42, 0.005);
}

}  // namespace
}  // namespace brace
