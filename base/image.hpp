#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace brace {

/// A CPU image, rows top to bottom, no padding; owns its pixels.
template <typename Pixel>
struct Image {
  int width_px = 0;
  int height_px = 0;
  std::vector<Pixel> pixels;  // height_px * width_px, row-major

  Image() = default;
  Image(int width, int height)
      : width_px(width),
        height_px(height),
        pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

  Pixel& at(int x, int y) { return pixels[index(x, y)]; }
  const Pixel& at(int x, int y) const { return pixels[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x);
  }
};

struct Rgba8 {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
  bool operator==(const Rgba8&) const = default;
};

struct RgbaF {
  float r = 0, g = 0, b = 0, a = 0;
};

using ImageRgba8 = Image<Rgba8>;
using ImageRgbaF = Image<RgbaF>;

/// Colour values are display-referred: 8-bit = round(255 * clamp(v, 0, 1)), no transfer curve is applied.
ImageRgba8 to_rgba8(const ImageRgbaF& image);

/// Throws brace::Error naming the file when it cannot be written or read: exit code 2, 3 for a full disk.
void write_png(const std::filesystem::path& path, const ImageRgba8& image);
ImageRgba8 read_png(const std::filesystem::path& path);

}  // namespace brace
