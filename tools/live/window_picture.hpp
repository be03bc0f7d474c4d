#pragma once

#include <array>

#include "base/image.hpp"

namespace brace {

/// Both panels side by side, left eye left, as large as they are.
ImageRgba8 side_by_side(const std::array<ImageRgba8, 2>& panels);

/// A picture fitted into a window of a size, its proportions kept, black around it; nearest pixels.
ImageRgba8 fitted(const ImageRgba8& picture, int width_px, int height_px);

}  // namespace brace
