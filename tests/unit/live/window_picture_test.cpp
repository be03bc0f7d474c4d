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

ImageRgba8 fitted(const ImageRgba8& picture, int width_px, int height_px) {
  ImageRgba8 window = plain(width_px, height_px, green);
  draw_fitted(picture, {0, 0, width_px, height_px}, window);
  return window;
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
  EXPECT_EQ(tall.at(5, 99), black);
  for (const auto& [width, height] : {std::pair(1, 1), {1, 500}, {500, 1}, {20, 10}}) {
    const ImageRgba8 window = fitted(both, width, height);
    EXPECT_EQ(window.width_px, width);
    EXPECT_EQ(window.height_px, height);
  }
  EXPECT_EQ(fitted(both, 20, 10).pixels, both.pixels) << "as it is where it fits";
}

TEST(WindowPicture, LeavesTheRestOfTheWindowAsItIs) {
  ImageRgba8 window = plain(30, 20, green);
  draw_fitted(plain(4, 4, red), {5, 3, 20, 10}, window);
  int reds = 0, blacks = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 30; ++x) {
      const bool inside = x >= 5 && x < 25 && y >= 3 && y < 13;
      EXPECT_EQ(inside, !(window.at(x, y) == green)) << x << ' ' << y;
      reds += window.at(x, y) == red;
      blacks += window.at(x, y) == black;
    }
  EXPECT_EQ(reds, 100);
  EXPECT_EQ(blacks, 100);
}

TEST(WindowLayout, GivesEveryPixelToOnePartAndTheEyesWhatIsLeft) {
  for (const int width : {1, 150, 599, 600, 1200, 4000})
    for (const int height : {1, 200, 349, 350, 640, 3000})
      for (const bool overlay : {false, true}) {
        const WindowLayout layout = lay_out(width, height, overlay);
        const auto area = [](const WindowRect& rect) { return rect.width * rect.height; };
        EXPECT_EQ(area(layout.eyes) + area(layout.column) + area(layout.strip), width * height);
        EXPECT_GT(layout.eyes.width, 0);
        EXPECT_GT(layout.eyes.height, 0);
        EXPECT_EQ(layout.column.width > 0, overlay && width >= 600);
        EXPECT_EQ(layout.strip.width > 0, overlay && height >= 350);
      }
}

}  // namespace
}  // namespace brace
