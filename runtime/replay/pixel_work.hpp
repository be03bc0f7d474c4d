#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "runtime/frame/frame_work.hpp"
#include "runtime/replay/error_meter.hpp"
#include "runtime/replay/panel_display.hpp"
#include "runtime/replay/vsync_selection.hpp"
#include "runtime/report/report_input.hpp"
#include "runtime/report/run_directory.hpp"

namespace brace {

/// The Vulkan renderer behind the frame loop: eye frames into the slots of the ray-casting swap-chain, warped
/// and distorted onto the panels; and, for the vsyncs that the session selects, the error of what the eye
/// gets against an ideal render from the true pose at photon time, and its pictures.
class PixelWork final : public FrameWork {
 public:
  /// Everything referred to must outlive it.
  struct Inputs {
    const gpu::Device& device;
    const Session& session;
    const Headset& headset;
    SceneOnDevice& scene;
    const VolumePlacement& placement;
    const ReplayOptions& options;  // with the stages of the ideal picture
    std::int64_t vsyncs = 0;       // of the whole run
    RunDirectory& run;             // where pictures go
    std::string picture_folder;    // in the run directory
    IdealCache& ideals;            // of this replay
    Watchdog* watchdog = nullptr;  // of the eye frames
  };
  explicit PixelWork(const Inputs& inputs);

  JobOutcome update(const UpdateRequest& request) override;
  JobOutcome cast(const CastRequest& request) override;
  CellOutcome cast_cell(const CellRequest& request) override;
  JobOutcome warp(const WarpRequest& request) override;
  void show(const ShowRequest& request) override;

  const std::vector<EyePicture>& pictures() const { return pictures_; }
  /// Null where no error is measured.
  ErrorMeter* error_meter() { return error_meter_ ? &*error_meter_ : nullptr; }
  const EyeRenderer& renderer() const { return renderer_; }
  const PanelDisplay& display() const { return display_; }

 private:
  JobOutcome show_transfer(std::int64_t version);
  void keep_pictures(std::int64_t vsync_index);

  Inputs in_;
  VsyncSelection error_at_, pictures_at_;
  EyeRenderer renderer_;
  std::array<EyePair, frame_slots> slots_;
  std::array<CellPoses, frame_slots> cell_poses_;  // of the slots, where cells have poses of their own
  PanelDisplay display_;
  std::shared_ptr<const PanelPair> waiting_, shown_;  // of the last warp; of the panels
  std::optional<ErrorMeter> error_meter_;
  std::vector<EyePicture> pictures_;
};

}  // namespace brace
