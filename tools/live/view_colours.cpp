#include "tools/live/view_colours.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "runtime/metrics/image_error.hpp"

namespace brace {

std::optional<ViewKind> view_of(std::string_view name) {
  for (std::size_t i = 0; i < view_names.size(); ++i)
    if (name == view_names[i]) return static_cast<ViewKind>(i);
  return std::nullopt;
}

namespace {

Rgba8 between(Rgba8 a, Rgba8 b, double t) {
  const auto channel = [t](std::uint8_t low, std::uint8_t high) {
    return static_cast<std::uint8_t>(std::lround(low + (high - low) * t));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b), 255};
}

constexpr std::array<Rgba8, 6> scale_stops = {Rgba8{20, 16, 60, 255}, {70, 30, 120, 255},
                                              {165, 45, 100, 255},    {225, 85, 60, 255},
                                              {250, 160, 50, 255},    {255, 250, 190, 255}};
constexpr std::array<Rgba8, 8> level_colours = {
    Rgba8{230, 60, 50, 255}, {245, 160, 40, 255}, {235, 225, 60, 255}, {80, 190, 80, 255},
    {60, 190, 210, 255},     {70, 100, 230, 255}, {150, 80, 210, 255}, {230, 100, 190, 255}};

}  // namespace

Rgba8 scale_colour(double t) {
  const double place = std::clamp(t, 0.0, 1.0) * (scale_stops.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), scale_stops.size() - 2);
  return between(scale_stops[low], scale_stops[low + 1], place - static_cast<double>(low));
}

Rgba8 level_colour(int level) {
  return level_colours[static_cast<std::size_t>(std::clamp(level, 0, 7))];
}

std::uint8_t grey_of(double t) {
  return static_cast<std::uint8_t>(std::lround(1.0 + 254.0 * std::clamp(t, 0.0, 1.0)));
}

ImageRgba8 coloured(const ImageRgba8& scalar) {
  std::array<Rgba8, 256> table;
  for (int v = 1; v < 256; ++v)
    table[static_cast<std::size_t>(v)] = scale_colour((v - 1) / 254.0);
  table[0] = {0, 0, 0, 255};
  ImageRgba8 picture(scalar.width_px, scalar.height_px);
  std::transform(scalar.pixels.begin(), scalar.pixels.end(), picture.pixels.begin(),
                 [&](const Rgba8& pixel) { return table[pixel.g]; });
  return picture;
}

ImageRgba8 difference_picture(const ImageRgba8& shown, const ImageRgba8& reference) {
  ImageRgba8 picture(shown.width_px, shown.height_px);
  const auto difference = [](const Rgba8& a, const Rgba8& b) {
    const int largest = std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
    return largest == 0 ? Rgba8{0, 0, 0, 255} : scale_colour(largest / (255.0 * difference_shown_max));
  };
  std::transform(shown.pixels.begin(), shown.pixels.end(), reference.pixels.begin(), picture.pixels.begin(),
                 difference);
  return picture;
}

ImageRgba8 dssim_picture(const ImageRgba8& shown, const ImageRgba8& reference) {
  ImageRgba8 picture(shown.width_px, shown.height_px);
  std::fill(picture.pixels.begin(), picture.pixels.end(), Rgba8{0, 0, 0, 255});
  const ImageRgbaF map = dssim_map(shown, reference);
  const int left = (shown.width_px - map.width_px) / 2, top = (shown.height_px - map.height_px) / 2;
  for (int y = 0; y < map.height_px; ++y)
    for (int x = 0; x < map.width_px; ++x) {
      const RgbaF& at = map.at(x, y);
      const double mean = (static_cast<double>(at.r) + at.g + at.b) / 3.0;
      if (mean > 0.0) picture.at(left + x, top + y) = scale_colour(mean / dssim_shown_max);
    }
  return picture;
}

ImageRgba8 tinted_by_level(const ImageRgba8& picture, const ImageRgba8& levels) {
  ImageRgba8 tinted(picture.width_px, picture.height_px);
  std::transform(picture.pixels.begin(), picture.pixels.end(), levels.pixels.begin(), tinted.pixels.begin(),
                 [](const Rgba8& seen, const Rgba8& level) {
                   if (level.g == 0) return Rgba8{0, 0, 0, 255};
                   const int index = (level.g - 1 + level_grey_step / 2) / level_grey_step;
                   return between(level_colour(index), seen, 0.55);
                 });
  return tinted;
}

}  // namespace brace
