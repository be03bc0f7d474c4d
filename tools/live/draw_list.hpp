#pragma once

#include <cstdint>

#include "base/image.hpp"

struct ImDrawData;

namespace brace {

/// The one texture of the overlay: coverage of the font's glyphs, and a white texel for all else.
struct CoverageTexture {
  int width_px = 0, height_px = 0;
  const std::uint8_t* coverage = nullptr;  // rows top to bottom; not owned
};

/// Paints Dear ImGui's triangles onto a picture, each over what lies there, clipped as they ask to be;
/// nearest texels. A pixel belongs to a triangle that holds its centre, and to one alone where two share an
/// edge. The picture stays opaque. User callbacks in the lists are left out.
void paint(const ImDrawData& drawn, const CoverageTexture& texture, ImageRgba8& onto);

}  // namespace brace
