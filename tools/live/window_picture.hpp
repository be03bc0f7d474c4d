#pragma once

#include <array>

#include "base/image.hpp"

namespace brace {

/// Both panels side by side, left eye left, as large as they are.
ImageRgba8 side_by_side(const std::array<ImageRgba8, 2>& panels);

struct WindowRect {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Where things stand in a window: the eyes, and beside and below them the overlay's parts. A part that the
/// window is too small for is empty; the eyes never are.
struct WindowLayout {
  static constexpr int column_width_px = 400, strip_height_px = 150;

  WindowRect eyes{}, column{}, strip{};
};
WindowLayout lay_out(int width_px, int height_px, bool overlay);

/// Fits a picture into a part of a window, its proportions kept, black around it; nearest pixels.
void draw_fitted(const ImageRgba8& picture, const WindowRect& into, ImageRgba8& window);

}  // namespace brace
