#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/image.hpp"
#include "runtime/display/display_pipeline.hpp"
#include "runtime/frame/frame_work.hpp"
#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/vsync_selection.hpp"
#include "runtime/report/report_input.hpp"
#include "runtime/report/run_directory.hpp"

namespace brace {

/// What the panels of both eyes show, indexed by sim::Eye.
using PanelPair = std::array<ImageRgba8, 2>;

/// The Vulkan renderer behind the frame loop: eye frames into the slots of the ray-casting swap-chain, warped
/// and distorted onto the panels; and, for the vsyncs that the session selects, the error of what the eye
/// gets against an ideal render from the true pose at photon time, and its pictures.
class PixelWork final : public FrameWork {
 public:
  struct Inputs {
    const gpu::Device& device;
    const Session& session;
    const Headset& headset;
    const SceneOnDevice& scene;
    const VolumePlacement& placement;
    const std::filesystem::path& data_folder;
    std::int64_t vsyncs = 0;      // of the whole run
    RunDirectory* run = nullptr;  // where pictures go; null: nowhere
    std::string picture_folder;   // in the run directory
  };
  explicit PixelWork(const Inputs& inputs);

  JobOutcome cast(const CastRequest& request) override;
  JobOutcome warp(const WarpRequest& request) override;
  ShowOutcome show(const ShowRequest& request) override;

  const std::vector<EyePicture>& pictures() const { return pictures_; }

 private:
  void keep_pictures(std::int64_t vsync_index);
  void render_ideal(const Pose& world_from_head);

  Inputs in_;
  VsyncSelection error_at_, pictures_at_;
  EyeRenderer renderer_;
  std::array<EyePair, frame_slots> slots_;
  DisplayPipeline display_;
  PanelPair waiting_, shown_;  // of the last warp; of the panel
  std::optional<EyeRenderer> ideal_renderer_;
  std::optional<DisplayPipeline> ideal_display_;
  EyePair ideal_eyes_;
  PanelPair ideal_;
  std::array<std::vector<std::uint8_t>, 2> visible_;
  std::vector<EyePicture> pictures_;
};

}  // namespace brace
