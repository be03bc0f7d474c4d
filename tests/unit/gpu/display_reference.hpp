#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "base/image.hpp"
#include "base/pose.hpp"
#include "gpu/gpu_fixture.hpp"
#include "runtime/display/display_pipeline.hpp"

namespace brace {

/// An eye turned by yaw, then by pitch.
inline Pose turned(double yaw_rad, double pitch_rad, const glm::dvec3& position = {}) {
  return {quat_exp({0, yaw_rad, 0}) * quat_exp({pitch_rad, 0, 0}), position};
}

/// A source picture on the host: a packed RGBA8 per pixel.
struct Picture {
  SourcePicture shape;
  std::vector<std::uint32_t> pixels;
  std::uint8_t value(int x, int y, std::size_t channel) const {
    return static_cast<std::uint8_t>(pixels[static_cast<std::size_t>(y * shape.width_px + x)] >>
                                     (8 * channel));
  }
};

Picture noise_picture(int width_px, int height_px, const sim::FovTangents& fov);
/// A picture of a function of the direction in the world, seen from an eye turned by `world_from_eye`.
Picture directional_picture(int width_px, int height_px, const sim::FovTangents& fov,
                            const Pose& world_from_eye);
double directional_value(const glm::dvec3& world_direction, std::size_t channel);

/// Re-projection of a direction, in tangents; none behind the old eye.
using WarpReference = std::function<std::optional<glm::dvec2>(glm::dvec2)>;
WarpReference no_warp();
WarpReference quad_warp(const Pose& world_from_old_eye, const Pose& world_from_new_eye, double far_plane_m);

struct ReferencePixel {
  double value = 0.0;      // 0 … 255
  bool covered = true;     // within usable radius and field of view, and in the picture
  bool uncovered = false;  // within usable radius and field of view, but not in the picture
  bool on_edge = false;    // so near an edge that rounding decides
};

/// What the panel shows, in double precision and written from the definitions in hmd_sim/lens.hpp.
class PanelReference {
 public:
  PanelReference(const PanelEye& eye, const Picture& picture, WarpReference warp);
  ReferencePixel at(std::size_t channel, int x, int y) const;

 private:
  const PanelEye& eye_;
  const Picture& picture_;
  WarpReference warp_;
  std::array<double, 3> usable_;
};

/// Everything to run the display kernel on a device of the tests.
struct DisplayRun {
  const gpu::Device& device;
  std::string warp = "none";                      // a folder of stages/warp
  std::map<std::string, double> parameters = {};  // of the stage, other than their defaults
  bool counters = false;
  bool skip_hidden = true;
  std::optional<LensTraits> traits = {};  // instead of the lens' own
  Pose world_from_old_eye = {}, world_from_new_eye = {};
  std::optional<ScanEye> new_eye_by_line = {};  // instead of world_from_new_eye

  struct Result {
    ImageRgba8 image;
    std::uint64_t pixels_written = 0;
    DisplayPipeline::Counts counts;
  };
  /// Depths in metres, as many as the picture has pixels, for warps that read them.
  Result show(const PanelEye& eye, const Picture& picture, std::span<const float> depths_m = {}) const;
  gpu::KernelDescription kernel(const LensTraits& lens) const;
};

/// Fails the test where a channel differs from the reference by more than one step of 255.
void expect_like_reference(const ImageRgba8& image, const PanelEye& eye, const Picture& picture,
                           const WarpReference& warp, const std::string& what);

}  // namespace brace
