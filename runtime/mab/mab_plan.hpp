#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hmd_sim/device_profile.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/mab/level_map.hpp"
#include "runtime/mab/live_texels.hpp"

namespace brace {

/// Where the gaze point of rays/mab comes from; all but `fixed` move.
enum class MabGaze { fixed, trace, script };

/// What a session asks of rays/mab.
struct MabSettings {
  LevelMap map = LevelMap::radius;
  int levels = 4;
  std::array<double, mab_levels_max> scale{};  // rays per pixel and axis, falling
  LevelAnchors anchors;                        // their `begin` for map = radius alone
  glm::dvec2 gaze_tan{0.0};                    // of a fixed gaze, in the frame of each eye
  double acuity_slope = 0.0;
  int reach = 1;  // texels that reconstruction reads to either side
  bool compact = true;
  MabGaze gaze = MabGaze::fixed;
  double ray_share = 1.0;  // most rays, over the pixels of both eyes
};

/// Throws input_error that names the parameter: scales that do not fall, anchors that do not rise.
MabSettings mab_settings(const PipelineStage& stage);

/// The levels of rays/mab over both eyes of a headset, and how many rays each quality leaves.
class MabPlan {
 public:
  struct Sizes {
    glm::ivec2 eye_px, panel_px;  // as rendered
    double resolution_scale = 1.0;
  };

  /// Throws input_error when the atlas is larger than 16383 texels across or down.
  MabPlan(const MabSettings& settings, const sim::DeviceProfile& profile, const Sizes& sizes);

  /// A gaze in the head frame from now on: new coordinates and rays for both eyes. Returns whether anything
  /// changed: not for a fixed gaze, for map = lens, and for less than a quarter of a pixel. At first the gaze
  /// is straight ahead.
  bool look_at(const glm::dvec3& gaze);

  const Atlas& atlas() const { return atlas_; }
  const std::vector<float>& coordinates(sim::Eye eye) const { return eyes_[index(eye)].coordinates; }

  /// Of moved(): t = step / steps(). A map that has the radial one's anchors as limits takes them in the
  /// lower half, in as many steps as that.
  int steps() const { return settings_.map == LevelMap::radius ? 256 : 512; }
  /// The anchors of the last step, steps(), are those of the settings.
  LevelWeights weights(sim::Eye eye, int step) const;
  /// Rays of both eyes.
  std::uint64_t rays(int step) const { return rays_[static_cast<std::size_t>(step)]; }
  /// The most rays with at most `quality` of what the levels give; the fewest there are if none has.
  int step_for(double quality) const;
  /// The step of a quality that load control asks for, 1 being what the levels and ray_share give.
  int step_asked(double quality) const { return step_for(quality * share_limit_); }
  double quality_min() const;
  MabRays make_rays(sim::Eye eye, int step) const;
  /// Rays of the largest grid of make_rays, wherever the gaze is.
  std::uint64_t capacity() const;

  /// For the report: levels, atlas, rays against pixels.
  std::string summary() const;

 private:
  struct EyePlan {
    std::vector<float> coordinates;
    LiveTexels texels;
    LevelAnchors anchors;
  };
  static std::size_t index(sim::Eye eye) { return static_cast<std::size_t>(eye); }
  void lay_levels();

  MabSettings settings_;
  std::array<sim::EyeProfile, 2> optics_;
  Sizes sizes_;
  glm::ivec2 eye_px_;
  std::array<glm::dvec2, 2> gaze_tan_{};  // in the frame of each eye
  Atlas atlas_;
  std::vector<EyePlan> eyes_;
  std::vector<std::uint64_t> rays_;  // by step
  std::uint64_t eye_rays_max_ = 0;
  double share_limit_ = 1.0;  // quality that ray_share leaves
};

}  // namespace brace
