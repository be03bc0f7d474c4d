#include "tools/live/view_colours.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace brace {
namespace {

double luminance(Rgba8 colour) {
  return 0.2126 * colour.r + 0.7152 * colour.g + 0.0722 * colour.b;
}

TEST(ViewColours, AreNamedOnce) {
  for (std::size_t i = 0; i < view_names.size(); ++i) {
    ASSERT_TRUE(view_of(view_names[i]));
    EXPECT_EQ(name_of(*view_of(view_names[i])), std::string(view_names[i]));
  }
  EXPECT_FALSE(view_of("pictur"));
}

TEST(ViewColours, GetLighterAlongTheScaleAndStandStillBeyondIt) {
  for (int i = 0; i < 255; ++i)
    EXPECT_LT(luminance(scale_colour(i / 255.0)), luminance(scale_colour((i + 1) / 255.0)) + 0.5) << i;
  EXPECT_GT(luminance(scale_colour(1.0)) - luminance(scale_colour(0.0)), 180.0);
  EXPECT_EQ(scale_colour(-3.0), scale_colour(0.0));
  EXPECT_EQ(scale_colour(7.0), scale_colour(1.0));
}

TEST(ViewColours, TellLevelsApart) {
  std::set<std::array<int, 3>> all;
  for (int level = 0; level < 8; ++level) {
    const Rgba8 colour = level_colour(level);
    all.insert({colour.r, colour.g, colour.b});
  }
  EXPECT_EQ(all.size(), 8U);
}

TEST(ViewColours, ShowNothingAsBlackAndScalarsByTheirGreen) {
  ImageRgba8 scalar(4, 1);
  scalar.pixels = {
      {9, 0, 9, 255}, {0, grey_of(0.0), 7, 255}, {3, grey_of(0.5), 0, 255}, {0, grey_of(1.0), 0, 255}};
  const ImageRgba8 seen = coloured(scalar);
  EXPECT_EQ(seen.at(0, 0), (Rgba8{0, 0, 0, 255}));
  EXPECT_EQ(seen.at(1, 0), scale_colour(0.0));
  EXPECT_EQ(seen.at(2, 0), scale_colour(0.5));
  EXPECT_EQ(seen.at(3, 0), scale_colour(1.0));
}

TEST(ViewColours, ShowTheLargestDifferenceOfThreeChannels) {
  ImageRgba8 a(3, 1), b(3, 1);
  a.pixels = {{10, 20, 30, 255}, {10, 20, 30, 255}, {200, 0, 0, 255}};
  b.pixels = {{10, 20, 30, 0}, {15, 20, 14, 255}, {0, 200, 0, 255}};  // alpha never counts
  const ImageRgba8 seen = difference_picture(a, b);
  EXPECT_EQ(seen.at(0, 0), (Rgba8{0, 0, 0, 255}));
  EXPECT_EQ(seen.at(1, 0), scale_colour(16.0 / 255.0 / difference_shown_max));
  EXPECT_EQ(seen.at(2, 0), scale_colour(1.0));
}

TEST(ViewColours, ShowDssimWhereItsWindowsAreCentred) {
  ImageRgba8 a(24, 20), b(24, 20);
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    a.pixels[i] = b.pixels[i] = {static_cast<std::uint8_t>(i * 37 % 251), 80, 90, 255};
  b.at(12, 10) = {255, 255, 255, 255};
  const ImageRgba8 seen = dssim_picture(a, b);
  const Rgba8 black{0, 0, 0, 255};
  EXPECT_NE(seen.at(12, 10), black);
  // A window of 8 holds the pixel if it is centred within 4 of it.
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x)
      EXPECT_TRUE(seen.at(x, y) == black || (std::abs(x - 12) <= 4 && std::abs(y - 10) <= 4))
          << x << ' ' << y;
  EXPECT_EQ(dssim_picture(a, a).at(12, 10), black);
}

TEST(ViewColours, TintByTheNearestLevel) {
  ImageRgba8 picture(3, 1), levels(3, 1);
  picture.pixels = {{100, 100, 100, 255}, {100, 100, 100, 255}, {100, 100, 100, 255}};
  const auto grey = [](int v) {
    const auto byte = static_cast<std::uint8_t>(v);
    return Rgba8{byte, byte, byte, 255};
  };
  levels.pixels = {grey(0), grey(1 + 2 * level_grey_step - 14), grey(1 + 2 * level_grey_step + 14)};
  const ImageRgba8 seen = tinted_by_level(picture, levels);
  EXPECT_EQ(seen.at(0, 0), (Rgba8{0, 0, 0, 255}));
  EXPECT_EQ(seen.at(1, 0), seen.at(2, 0)) << "both are level 2";
  const Rgba8 colour = level_colour(2);
  EXPECT_NEAR(seen.at(1, 0).r, 0.45 * colour.r + 55.0, 1.0);
}

}  // namespace
}  // namespace brace
