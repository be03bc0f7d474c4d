#pragma once

#include <cstdint>
#include <string>

#include "runtime/stereo/rectification.hpp"

namespace brace {

struct StereoSettings {
  int layers = 0;  // 0: as many as near_m needs
  double near_m = 0.3;
  int bytes_per_texel = 8;
  bool interpolates = false;  // two columns per pixel
  int interleave = 1;         // one ray of so many leaves segments, in columns as wide
  bool fresh_rays = false;    // for pixels that look behind stopped rays

  double columns_per_pixel() const { return interpolates ? 2.0 : 1.0 / interleave; }
  /// Between the rays that share no column at any depth, at the same depth.
  double columns_per_ray(double pixels_per_ray) const {
    return interpolates ? 2.0 * pixels_per_ray : pixels_per_ray;
  }
};

/// What a device can hold.
struct StereoMemory {
  std::uint64_t binding_bytes_max = 0;
  std::uint64_t memory_bytes = 0;
};

/// What single-pass stereo takes, decided before anything is allocated.
struct StereoPlan {
  /// The disparity varies by less than a pixel over the volume: no layers, the second eye's picture is the
  /// first's, shifted.
  bool layers_left_out = false;
  int width_px = 0, height_px = 0;  // of an eye's picture
  int layers = 0;
  double near_m = 0.0;  // of the bounding sphere; nearer, layers may be too few
  RayMargins margins;
  int across = 0, down = 0;  // rays, margins included
  std::uint64_t bytes = 0;   // of the layers
  std::string summary;       // for the report
  int columns = 0;           // of a layer
  StereoSettings settings;
  std::optional<Rectification> rectification;  // of canted displays: what the figures above are of
};

/// Layers with which no two rays share a texel where the disparity varies by `range_px` over the volume.
int layers_for(const StereoSettings& settings, const StereoGeometry& geometry, double range_px);

/// Throws input_error when the layers do not fit, naming settings that would, and for settings that leave no
/// layer to work with.
StereoPlan plan_stereo(const StereoSettings& settings, const StereoGeometry& geometry, int width_px,
                       int height_px, double radius_m, const StereoMemory& memory);

}  // namespace brace
