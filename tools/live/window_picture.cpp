#include "tools/live/window_picture.hpp"

#include <algorithm>

namespace brace {

ImageRgba8 side_by_side(const std::array<ImageRgba8, 2>& panels) {
  ImageRgba8 both(panels[0].width_px + panels[1].width_px,
                  std::max(panels[0].height_px, panels[1].height_px));
  int left = 0;
  for (const ImageRgba8& panel : panels) {
    for (int y = 0; y < panel.height_px; ++y)
      for (int x = 0; x < panel.width_px; ++x)
        both.at(left + x, y) = panel.at(x, y);
    left += panel.width_px;
  }
  return both;
}

ImageRgba8 fitted(const ImageRgba8& picture, int width_px, int height_px) {
  ImageRgba8 window(width_px, height_px);
  std::fill(window.pixels.begin(), window.pixels.end(), Rgba8{0, 0, 0, 255});
  const double scale = std::min(static_cast<double>(width_px) / picture.width_px,
                                static_cast<double>(height_px) / picture.height_px);
  const int width = std::clamp(static_cast<int>(picture.width_px * scale), 1, width_px);
  const int height = std::clamp(static_cast<int>(picture.height_px * scale), 1, height_px);
  const int left = (width_px - width) / 2, top = (height_px - height) / 2;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      window.at(left + x, top + y) = picture.at(x * picture.width_px / width, y * picture.height_px / height);
  return window;
}

}  // namespace brace
