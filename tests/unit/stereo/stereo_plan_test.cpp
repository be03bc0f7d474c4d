#include "runtime/stereo/stereo_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace {
namespace {

using ::testing::HasSubstr;

constexpr StereoMemory kPlenty{1ull << 40, 1ull << 42};

EyeView eye_at(double x_m) {
  EyeView eye;
  eye.world_from_eye.position = {x_m, 0.0, 0.0};
  eye.width_px = 270;
  eye.height_px = 300;
  return eye;
}

StereoPlan plan(const StereoSettings& settings, double eye_distance_m = 0.064,
                const StereoMemory& memory = kPlenty) {
  return plan_stereo(settings, {stereo_pair(eye_at(0.0), eye_at(eye_distance_m), false)}, 0.5, memory);
}

template <typename Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    return error.what();
  }
  return "no error";
}

TEST(StereoPlan, LayersOfTheNearPlaneAreThoseThatGiveThatNearPlane) {
  const StereoPlan automatic = plan({.layers = 0, .near_m = 0.25});
  const StereoPlan given = plan({.layers = automatic.layers});
  EXPECT_LE(given.near_m, 0.25);
  EXPECT_GT(plan({.layers = automatic.layers - 1}).near_m, 0.25);
}

TEST(StereoPlan, MemoryIsSaidAndRefusedWithWhatWouldFit) {
  const StereoPlan fits = plan({.layers = 20});
  EXPECT_EQ(fits.bytes, layer_bytes(270, fits.down, 20, 8));
  EXPECT_THAT(fits.summary, HasSubstr("20 layers"));
  const StereoMemory small{fits.bytes - 1, 1ull << 42};
  EXPECT_THAT(message_of([&] { plan({.layers = 20}, 0.064, small); }), HasSubstr("layers = 19"));
  EXPECT_EQ(plan({.layers = 19}, 0.064, small).layers, 19);
}

TEST(StereoPlan, LessThanAPixelOfDisparityNeedsNoLayers) {
  EXPECT_TRUE(plan({}, 0.0).layers_left_out);
  const StereoPlan tiny = plan({}, 0.001);
  EXPECT_TRUE(tiny.layers_left_out);
  EXPECT_EQ(tiny.bytes, 0u);
  EXPECT_THAT(tiny.summary, HasSubstr("px"));
  EXPECT_FALSE(plan({}).layers_left_out);
}

TEST(StereoPlan, OneLayerIsTooFew) {
  EXPECT_THAT(message_of([] { plan({.layers = 1}); }), HasSubstr("layers = 1"));
}

TEST(StereoGeometry, AsymmetricFrustaShiftAndScale) {
  EyeView left = eye_at(0.0), right = eye_at(0.06);
  left.tan_left = -1.4;
  left.tan_right = 1.2;
  right.tan_left = -1.25;
  right.tan_right = 1.4;
  right.tan_top = 1.01;
  const StereoGeometry geometry = stereo_geometry(left, right);
  // A point straight before the left eye, and where each eye's own projection puts it.
  const double z_m = 0.8;
  const double left_column = 1.4 / 2.6 * 270.0;
  EXPECT_NEAR(geometry.column(left_column, z_m), (-0.06 / z_m + 1.25) / 2.65 * 270.0, 1e-9);
  const double row = 120.5;
  const double tan_y = 1.01 - row / 300.0 * 2.01;
  EXPECT_NEAR(geometry.rows_per_row * row + geometry.row_shift, (1.0 - tan_y) / 2.0 * 300.0, 1e-9);
}

TEST(StereoGeometry, CantedDisplaysAreRefusedByName) {
  EyeView right = eye_at(0.06);
  right.world_from_eye.orientation = quat_exp({0.0, 0.17, 0.0});
  EXPECT_THAT(message_of([&] { stereo_geometry(eye_at(0.0), right); }), HasSubstr("canted by 9.7"));
  EXPECT_THAT(message_of([&] { stereo_geometry(eye_at(0.06), eye_at(0.0)); }), HasSubstr("two_pass"));
}

TEST(DepthRange, OfABoxBeforeAroundAndBehindTheEye) {
  VolumeInfo volume;
  volume.dims = {8, 8, 8};
  VolumePlacement placement;
  placement.size_m = 0.4;
  const auto at = [&](double z_m) {
    placement.world_from_volume.position = {0.0, 0.0, z_m};
    return depth_range(eye_at(0.0), volume, placement);
  };
  EXPECT_NEAR(at(-1.0).near_m, 0.8, 1e-12);
  EXPECT_NEAR(at(-1.0).far_m, 1.2, 1e-12);
  EXPECT_LT(at(0.1).near_m, 0.0);
  EXPECT_LT(at(3.0).far_m, 0.0);
}

}  // namespace
}  // namespace brace
