#include "tools/live/window_picture.hpp"

#include <algorithm>
#include <vector>

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

WindowLayout lay_out(int width_px, int height_px, bool overlay) {
  WindowLayout layout{.eyes = {0, 0, width_px, height_px}};
  if (!overlay) return layout;
  const int least_for_eyes_px = 200;
  if (width_px >= WindowLayout::column_width_px + least_for_eyes_px) {
    layout.eyes.width -= WindowLayout::column_width_px;
    layout.column = {layout.eyes.width, 0, WindowLayout::column_width_px, height_px};
  }
  if (height_px >= WindowLayout::strip_height_px + least_for_eyes_px) {
    layout.eyes.height -= WindowLayout::strip_height_px;
    layout.strip = {0, layout.eyes.height, layout.eyes.width, WindowLayout::strip_height_px};
  }
  return layout;
}

namespace {

void fill_black(const WindowRect& rect, ImageRgba8& window) {
  if (rect.width <= 0) return;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    Rgba8* const row = &window.at(rect.x, y);
    std::fill(row, row + rect.width, Rgba8{0, 0, 0, 255});
  }
}

}  // namespace

void draw_fitted(const ImageRgba8& picture, const WindowRect& into, ImageRgba8& window) {
  const double scale = std::min(static_cast<double>(into.width) / picture.width_px,
                                static_cast<double>(into.height) / picture.height_px);
  const int width = std::clamp(static_cast<int>(picture.width_px * scale), 1, into.width);
  const int height = std::clamp(static_cast<int>(picture.height_px * scale), 1, into.height);
  const int left = into.x + (into.width - width) / 2, top = into.y + (into.height - height) / 2;
  fill_black({into.x, into.y, into.width, top - into.y}, window);
  fill_black({into.x, top + height, into.width, into.y + into.height - top - height}, window);
  fill_black({into.x, top, left - into.x, height}, window);
  fill_black({left + width, top, into.x + into.width - left - width, height}, window);
  std::vector<int> columns(static_cast<std::size_t>(width));
  for (int x = 0; x < width; ++x)
    columns[static_cast<std::size_t>(x)] = x * picture.width_px / width;
  int drawn = -1;
  for (int y = 0; y < height; ++y) {
    Rgba8* const row = &window.at(left, top + y);
    const int from = y * picture.height_px / height;
    if (from == drawn) {
      std::copy_n(&window.at(left, top + y - 1), width, row);
      continue;
    }
    drawn = from;
    const Rgba8* const source = &picture.at(0, from);
    for (int x = 0; x < width; ++x)
      row[x] = source[columns[static_cast<std::size_t>(x)]];
  }
}

}  // namespace brace
