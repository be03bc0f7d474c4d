#pragma once

#include <cstdint>
#include <vector>

#include "base/pose.hpp"
#include "hmd_sim/lens.hpp"
#include "hmd_sim/vsync.hpp"
#include "plugins/abi/glsl/brace/display_params.h"

namespace brace {

/// One eye's panel as it is simulated: pixels at the session's resolution scale, lens and what the eye sees.
struct PanelEye {
  int width_px = 0;
  int height_px = 0;
  sim::EyeLens lens;
  sim::FovTangents fov;
  sim::ScanFraction scan{};  // of its points
};

/// The eye frame that a panel image is made from.
struct SourcePicture {
  int width_px = 0;  // rows run top to bottom
  int height_px = 0;
  sim::FovTangents fov;  // at the picture's edges, in the eye frame it was rendered in
};

/// What decides which display kernel a lens needs; both eyes of a headset share one kernel.
struct LensTraits {
  sim::LensKind kind = sim::LensKind::identity;
  bool one_centre = false;  // of the three channels
  bool one_fetch = false;   // same polynomial and centre: one fetch serves the three channels

  bool operator==(const LensTraits&) const = default;
};

LensTraits lens_traits(const sim::EyeLens& lens);
/// The traits that serve both eyes. Throws input_error when the eyes have different lens models.
LensTraits common_traits(const LensTraits& left, const LensTraits& right);

/// Parameters of one eye with equal poses. Throws input_error when the panel or picture is empty or smaller
/// than 2 x 2 pixels, or a field of view is not finite or has no area.
BraceDisplayParams display_params(const PanelEye& eye, const SourcePicture& source);

/// Of an eye at the photons of the first and of the last line of its panel's scan-out.
struct ScanEye {
  Pose world_from_first_line, world_from_last_line;
};

/// Sets the poses: of the eye when the source picture was rendered, and of the eye now, for the whole panel
/// or line by line. Throws input_error when one is not finite.
void set_poses(BraceDisplayParams& params, const Pose& world_from_old_eye, const Pose& world_from_new_eye);
void set_poses(BraceDisplayParams& params, const Pose& world_from_old_eye, const ScanEye& new_eye);

/// For every pixel of the source picture, row by row, how far the scan-out is where the panel shows it in
/// green (0 at the first line, 1 at the last); 0.5 for pixels that the panel does not show.
std::vector<float> scan_fractions(const PanelEye& eye, const SourcePicture& source);

/// Tiles in which at least one pixel is visible, row by row: column in the low, row in the high 16 bits. A
/// pixel is visible when in any channel it lies within the usable radius and looks into the field of view.
inline constexpr int tile_width_px = 32;
inline constexpr int tile_height_px = 8;
std::vector<std::uint32_t> visible_tiles(const PanelEye& eye);

}  // namespace brace
