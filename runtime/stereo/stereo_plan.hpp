#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/stereo/rectification.hpp"

namespace brace {

struct StereoSettings {
  int layers = 0;  // 0: as many as near_m needs
  double near_m = 0.3;
  int bytes_per_texel = 8;
  bool interpolates = false;  // two columns per pixel
  int interleave = 1;         // one ray of so many leaves segments, in columns as wide
  bool fresh_rays = false;    // for pixels that look behind stopped rays
  bool from_middle = false;   // rays from between the eyes, both of them composed

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

/// A picture that is composed from rays, and where those fall on it. Each of the rays' levels (rays/mab)
/// makes a picture of its own.
struct StereoPair {
  StereoGeometry geometry;
  int width_px = 0, height_px = 0;  // of the picture, and of what the rays were cast for
  bool is_mirrored = false;         // the geometry is that of mirrored(): the eye is to the left of the rays'
  struct Tangents {
    double left = 0.0, top = 0.0, per_column = 0.0, per_row = 0.0;
  } tangents;  // of the composed picture
};

/// The pair of a reference eye and one to its right, or in a mirror to its left.
StereoPair stereo_pair(const EyeView& reference, const EyeView& composed, bool is_mirrored);

/// The place between both eyes, looking as the left one does.
EyeView middle_of(const EyeViews& eyes);

/// One of the pictures of a plan: its layers, and its rays in the order of its columns.
struct StereoPicture {
  StereoPair pair;
  int layers = 0;
  int columns = 0;                               // of a layer
  int left = 0, top = 0;                         // rays beside and above what they were cast for
  int across = 0, down = 0;                      // rays, those included
  std::uint64_t first_texel = 0, first_ray = 0;  // in the buffers that all pictures share
};

/// What single-pass stereo takes, decided before anything is allocated.
struct StereoPlan {
  /// The disparity varies by less than a pixel over the volume: no layers, the second eye's picture is the
  /// first's, shifted.
  bool layers_left_out = false;
  int width_px = 0, height_px = 0;  // of an eye's picture
  int layers = 0;                   // of the first picture
  double near_m = 0.0;              // of the bounding sphere; nearer, layers may be too few
  RayMargins margins;               // of the rays; none with rays of their own order (rays/mab)
  int across = 0, down = 0;         // rays, margins included
  std::uint64_t bytes = 0;          // of the layers
  std::uint64_t rays = 0;           // of all pictures
  std::string summary;              // for the report
  int columns = 0;                  // of a layer of the first picture
  StereoSettings settings;
  std::vector<StereoPicture> pictures;  // level by level for one eye, then for the next
  int levels = 0;                       // of rays/mab, each with pictures of its own; 0: rays are pixels
  std::optional<Rectification> rectification;  // of canted displays: what the figures above are of
};

/// Layers with which no two rays share a texel where the disparity varies by `range_px` over the volume.
int layers_for(const StereoSettings& settings, const StereoGeometry& geometry, double range_px);

/// `pairs`: one per composed eye, or with `levels` > 0 that many per composed eye, the finest first; `layers`
/// counts for the first. Throws input_error when the layers do not fit, naming settings that would, and for
/// settings that leave no layer to work with.
StereoPlan plan_stereo(const StereoSettings& settings, const std::vector<StereoPair>& pairs, double radius_m,
                       const StereoMemory& memory, int levels = 0);

}  // namespace brace
