#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/image.hpp"

namespace brace {

/// What the window shows of the eyes.
enum class ViewKind {
  picture,
  difference,  // from the ideal picture, largest of three channels
  dssim,       // the same by windows of 8 x 8
  levels,      // of rays/mab
  skip_steps,  // per ray
  samples,     // per ray
  depth        // of the first visible sample
};
inline constexpr std::array view_names = {"picture",    "difference", "dssim", "levels",
                                          "skip_steps", "samples",    "depth"};
inline const char* name_of(ViewKind kind) {
  return view_names[static_cast<std::size_t>(kind)];
}
std::optional<ViewKind> view_of(std::string_view name);

/// How to read a view's colours.
struct ViewLegend {
  std::string words;
  std::string low, high;  // ends of the colour scale; both empty: there is none
  std::vector<std::pair<Rgba8, std::string>> swatches{};  // instead of a scale
};

/// The colour scale, 0 to 1: dark blue over red to pale yellow, ever lighter.
Rgba8 scale_colour(double t);
/// Of the levels of an atlas, 0 to 7.
Rgba8 level_colour(int level);

/// Panels that show a scalar as grey v hold black where there is nothing and else 1 + 254 t; their green
/// channel, which the lens moves as the profile says, gets the scale's colours.
std::uint8_t grey_of(double t);
ImageRgba8 coloured(const ImageRgba8& scalar);

/// Difference of full scale that has the scale's last colour.
inline constexpr double difference_shown_max = 0.25;
/// The largest difference of three channels at every pixel, on the colour scale; equal pixels are black.
ImageRgba8 difference_picture(const ImageRgba8& shown, const ImageRgba8& reference);

/// DSSIM that has the scale's last colour.
inline constexpr double dssim_shown_max = 0.25;
/// The mean DSSIM of the three channels of the window around every pixel; black where no window is centred.
ImageRgba8 dssim_picture(const ImageRgba8& shown, const ImageRgba8& reference);

/// A picture under the colours of its levels, given as grey 1 + 30 * level by `levels`; black stays black.
inline constexpr int level_grey_step = 30;
ImageRgba8 tinted_by_level(const ImageRgba8& picture, const ImageRgba8& levels);

}  // namespace brace
