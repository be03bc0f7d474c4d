#pragma once

#include <cstdint>
#include <string>

#include "runtime/stereo/stereo_geometry.hpp"

namespace brace {

struct StereoSettings {
  int layers = 0;  // 0: as many as near_m needs
  double near_m = 0.3;
  int bytes_per_texel = 8;
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
  int layers = 0;
  double near_m = 0.0;  // of the bounding sphere; nearer, layers may be too few
  RayMargins margins;
  int across = 0, down = 0;  // rays, margins included
  std::uint64_t bytes = 0;   // of the layers
  std::string summary;       // for the report
};

/// Throws input_error when the layers do not fit, naming settings that would, and for settings that leave no
/// layer to work with.
StereoPlan plan_stereo(const StereoSettings& settings, const StereoGeometry& geometry, int width_px,
                       int height_px, double radius_m, const StereoMemory& memory);

}  // namespace brace
