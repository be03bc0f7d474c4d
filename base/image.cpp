#include "base/image.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include <png.h>

#include "base/error.hpp"

namespace brace {

namespace {

std::uint8_t to_8bit(float v) {
  // The comparison order sends NaN to 0.
  return static_cast<std::uint8_t>(std::lround((v > 0.0f ? std::min(v, 1.0f) : 0.0f) * 255.0f));
}

png_image png_header(png_uint_32 width, png_uint_32 height) {
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  header.width = width;
  header.height = height;
  header.format = PNG_FORMAT_RGBA;
  return header;
}

}  // namespace

ImageRgba8 to_rgba8(const ImageRgbaF& image) {
  ImageRgba8 out(image.width_px, image.height_px);
  std::transform(image.pixels.begin(), image.pixels.end(), out.pixels.begin(), [](const RgbaF& p) {
    return Rgba8{to_8bit(p.r), to_8bit(p.g), to_8bit(p.b), to_8bit(p.a)};
  });
  return out;
}

void write_png(const std::filesystem::path& path, const ImageRgba8& image) {
  png_image header =
      png_header(static_cast<png_uint_32>(image.width_px), static_cast<png_uint_32>(image.height_px));
  // Encoded in memory and written here: libpng does not tell a full disk from a missing folder.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<char> bytes(size);
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr)) {
    throw input_error("{}: cannot encode the picture: {}", path.string(), header.message);
  }
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(size));
  file.close();
  if (file) return;
  if (errno == ENOSPC || errno == EDQUOT) {
    throw device_error("{}: {}; free some space or choose another folder with --out", path.string(),
                       std::strerror(errno));
  }
  throw input_error("{}: cannot write the picture: {}", path.string(), std::strerror(errno));
}

ImageRgba8 read_png(const std::filesystem::path& path) {
  png_image header = png_header(0, 0);
  if (!png_image_begin_read_from_file(&header, path.c_str())) {
    throw input_error("{}: cannot read the picture: {}", path.string(), header.message);
  }
  header.format = PNG_FORMAT_RGBA;
  ImageRgba8 image(static_cast<int>(header.width), static_cast<int>(header.height));
  if (!png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr)) {
    throw input_error("{}: cannot read the picture: {}", path.string(), header.message);
  }
  return image;
}

}  // namespace brace
