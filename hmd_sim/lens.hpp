#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>

#include "base/image.hpp"

namespace brace::sim {

// From a panel pixel to a direction, the one mapping that everything here and in the shaders follows:
//
//   panel uv      u right, v down, (0,0) the panel's top left corner, (1,1) its bottom right; a pixel (x,y)
//   has
//                 its centre at ((x + 0.5) / width_px, (y + 0.5) / height_px)
//   display point p = ((u - centre_uv.x) * panel_size_units.x, -(v - centre_uv.y) * panel_size_units.y),
//                 lens units, y up, per channel as each channel may have its own centre
//   source point  p * L(|p|), L the lens model of the channel ("display to source": what a warp shader
//   evaluates) tangents      (tan x, tan y) = source point * tan_per_unit (per axis): the direction (tan x,
//   tan y, -1) in
//                 the eye frame (+X right, +Y up, -Z forward); |p| = 0 is the eye's forward axis
//   target uv     ((tan x - left) / (right - left), (top - tan y) / (top - bottom)): u right, v down, of the
//                 picture rendered through the FOV tangents
//
// Nothing in it depends on a pixel count, so a panel or target of reduced resolution needs no other lens.

/// Signed tangents of the half angles in the eye frame: left and bottom are negative.
struct FovTangents {
  double left = -1, right = 1, bottom = -1, top = 1;
  double width() const { return right - left; }
  double height() const { return top - bottom; }
};

enum class LensKind {
  none_published,  // no source gives this device's lens; maps like identity
  identity,        // L = 1
  brown_conrady,   // L = 1 + k0 r^2 + k1 r^4 + k2 r^6
  panotools,       // L = k0 + k1 r + k2 r^2 + k3 r^3 + k4 r^4 (OpenHMD's d, c, b, a, 0)
  vive             // L = 1 / (1 + k0 r^2 + k1 r^4 + k2 r^6) + k3
};

std::string_view to_string(LensKind kind);

enum class Channel { red = 0, green = 1, blue = 2 };
inline constexpr std::array<Channel, 3> all_channels{Channel::red, Channel::green, Channel::blue};

struct LensChannel {
  std::array<double, 5> k{};  // in the order given at LensKind; unused ones are 0
  glm::dvec2 centre_uv{0.5};  // panel uv of the lens centre
};

/// The lens in front of one eye's panel.
struct EyeLens {
  LensKind kind = LensKind::identity;
  std::array<LensChannel, 3> rgb;  // indexed by Channel
  glm::dvec2 panel_size_units{1};  // the panel's width and height in lens units
  glm::dvec2 tan_per_unit{2};      // tangent per lens unit of the source point
  double cutoff_radius = std::numeric_limits<double>::infinity();  // lens units; the calibration ends here
};

/// A lens that shows the render target linearly over the panel: panel uv equals target uv.
EyeLens identity_lens(const FovTangents& fov);

// --- the radial model; radii in lens units, r >= 0 ---

double lens_scale(LensKind kind, const std::array<double, 5>& k, double r);             // L(r)
double lens_scale_derivative(LensKind kind, const std::array<double, 5>& k, double r);  // dL/dr
double lens_forward(LensKind kind, const std::array<double, 5>& k, double r);           // r L(r)

/// The largest radius up to which r L(r) grows and L is positive: the first r with r L'/L <= -1, or the pole
/// of a rational model, whichever is nearer; r_max if there is none before it.
double fold_over_radius(LensKind kind, const std::array<double, 5>& k, double r_max);

/// The display radius in [0, usable_radius] with r L(r) = source_radius; none if there is no such radius
/// (never one from a wrong branch). Bracketed Newton, at most 13 iterations (up to 60 next to a fold);
/// `iterations` receives the number taken.
std::optional<double> lens_inverse(LensKind kind, const std::array<double, 5>& k, double source_radius,
                                   double usable_radius, int* iterations = nullptr);

/// min(fold-over, cut-off, farthest panel corner from the channel's centre).
double usable_radius(const EyeLens& lens, Channel channel);

// --- whole mapping ---

/// (tan x, tan y) seen by a panel point; none beyond the usable radius.
std::optional<glm::dvec2> panel_to_tangents(const EyeLens& lens, Channel channel, glm::dvec2 panel_uv);
/// The same for loops: `usable` is usable_radius(lens, channel), which is costly, found once by the caller.
std::optional<glm::dvec2> panel_to_tangents(const EyeLens& lens, Channel channel, double usable,
                                            glm::dvec2 panel_uv);

/// The panel point that shows a direction; none when no point within the usable radius does. The result may
/// lie off the panel (outside 0..1).
std::optional<glm::dvec2> tangents_to_panel(const EyeLens& lens, Channel channel, glm::dvec2 tangents);
std::optional<glm::dvec2> tangents_to_panel(const EyeLens& lens, Channel channel, double usable,
                                            glm::dvec2 tangents);

glm::dvec2 tangents_to_target_uv(const FovTangents& fov, glm::dvec2 tangents);
glm::dvec2 target_uv_to_tangents(const FovTangents& fov, glm::dvec2 target_uv);

/// Whether the lens does nothing (panel uv equals target uv within 1e-9 for every channel).
bool lens_is_identity(const EyeLens& lens, const FovTangents& fov);
/// Whether the three channels share coefficients and centre: one fetch serves all.
bool lens_channels_equal(const EyeLens& lens);

// --- derived tables ---

/// What an eye cannot see. 1 = hidden, 0 = visible.
struct HiddenAreaMask {
  Image<std::uint8_t> panel;   // panel pixels that see no source pixel in any channel
  Image<std::uint8_t> source;  // render-target pixels that no panel pixel shows or reads bilinearly
};

/// Sizes are those the caller renders at (> 0), not necessarily the device's own.
HiddenAreaMask hidden_area_mask(const EyeLens& lens, const FovTangents& fov, glm::ivec2 panel_size_px,
                                glm::ivec2 target_size_px);

struct DistortionVertex {
  glm::dvec2 panel_uv;
  std::array<glm::dvec2, 3> tangents;  // per channel; beyond the usable radius those of the usable radius
  bool visible = false;                // every channel within its usable radius and the FOV
};

/// (columns + 1) x (rows + 1) vertices, row-major from the top left.
struct DistortionMesh {
  int columns = 0, rows = 0;
  std::vector<DistortionVertex> vertices;
};

DistortionMesh distortion_mesh(const EyeLens& lens, const FovTangents& fov, int columns, int rows);

}  // namespace brace::sim
