#include "tools/live/window_picture.hpp"

#include <gtest/gtest.h>

namespace brace {
namespace {

ImageRgba8 plain(int width_px, int height_px, Rgba8 colour) {
  ImageRgba8 image(width_px, height_px);
  for (Rgba8& pixel : image.pixels)
    pixel = colour;
  return image;
}

constexpr Rgba8 red{255, 0, 0, 255}, green{0, 255, 0, 255}, black{0, 0, 0, 255};

TEST(WindowPicture, ShowsTheLeftEyeOnTheLeft) {
  const ImageRgba8 both = side_by_side({plain(3, 4, red), plain(5, 4, green)});
  EXPECT_EQ(both.width_px, 8);
  EXPECT_EQ(both.at(2, 3), red);
  EXPECT_EQ(both.at(3, 0), green);
}

TEST(WindowPicture, KeepsItsProportionsInEveryWindow) {
  const ImageRgba8 both = side_by_side({plain(10, 10, red), plain(10, 10, green)});
  const ImageRgba8 wide = fitted(both, 100, 20);
  EXPECT_EQ(wide.at(0, 10), black);
  EXPECT_EQ(wide.at(31, 10), red);
  EXPECT_EQ(wide.at(68, 10), green);
  EXPECT_EQ(wide.at(99, 10), black);
  const ImageRgba8 tall = fitted(both, 20, 100);
  EXPECT_EQ(tall.at(5, 0), black);
  EXPECT_EQ(tall.at(5, 50), red);
  for (const auto& [width, height] : {std::pair(1, 1), {1, 500}, {500, 1}, {20, 10}}) {
    const ImageRgba8 window = fitted(both, width, height);
    EXPECT_EQ(window.width_px, width);
    EXPECT_EQ(window.height_px, height);
  }
  EXPECT_EQ(fitted(both, 20, 10).pixels, both.pixels) << "as it is where it fits";
}

}  // namespace
}  // namespace brace
