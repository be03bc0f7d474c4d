#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/image.hpp"
#include "runtime/display/display_pipeline.hpp"
#include "runtime/frame/frame_work.hpp"
#include "runtime/replay/cell_map.hpp"
#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/layer_warp.hpp"
#include "runtime/replay/native_warp.hpp"

namespace brace {

/// What the panels of both eyes show, indexed by sim::Eye.
using PanelPair = std::array<ImageRgba8, 2>;

/// Head poses that the cells of an eye frame were cast from, indexed by sim::Eye.
struct CellPoses {
  std::array<CellCuts, 2> cuts;
  std::array<std::vector<Pose>, 2> world_from_head;
};

/// One display image: eye frames rendered from one head pose, shown to a head at another.
struct PanelImage {
  const EyePair& eyes;
  Pose render_world_from_head{}, warp_world_from_head{};
  std::int64_t frame = 0;
  std::int64_t vsync_index = 0;
  std::optional<ScanPoses> warp_scan{};   // for warps by line; without, the whole panel is of the warp's pose
  const CellPoses* cell_poses = nullptr;  // read where the display was told of them
};

/// The panels of a session's headset behind one warp stage. Device and headset must outlive it.
class PanelDisplay {
 public:
  /// `warp` is a GLSL stage.
  PanelDisplay(const gpu::Device& device, const Headset& headset, const PipelineStage& warp,
               const std::filesystem::path& data_folder);
  /// `warp` is any; a native one is activated with `activation`, and its pictures are shown by `no_warp`.
  /// `cells_have_poses`: of every image that is shown.
  PanelDisplay(const gpu::Device& device, const Headset& headset, const PipelineStage& warp,
               const PipelineStage& no_warp, const ActivationInput& activation,
               const std::filesystem::path& data_folder, bool cells_have_poses = false);

  /// Warps, distorts and keeps the panels' pictures.
  JobOutcome show(const PanelImage& image);

  /// The panels' pictures after the last show().
  PanelPair read() const;

  /// Pixels of all images so far that show something else than the eye frame, or nothing: of warps that read
  /// depth or layers alone, zero for others.
  DisplayPipeline::Counts counted() const;
  bool fills() const { return pipeline_.uses_depth() || layered_; }
  std::int64_t images() const { return images_; }

  /// Work of one show(): known beforehand, unless counts_work() is true; then that of the last one.
  WorkCounts work() const;
  bool counts_work() const { return layered_.has_value(); }

  const LensTraits& lens() const { return lens_; }

 private:
  PanelDisplay(const gpu::Device& device, const Headset& headset, const PipelineStage& warp, bool cell_poses,
               const std::filesystem::path& data_folder);
  void set_eye(const PanelImage& image, sim::Eye eye, const ScanPoses& scan);

  const gpu::Device& device_;
  const Headset& headset_;
  LensTraits lens_;
  bool by_line_;                       // the warp
  std::optional<NovelView::Box> box_;  // of the volume, where it is known
  DisplayPipeline pipeline_;
  std::optional<NativeWarp> native_warp_;
  std::optional<LayerWarp> layered_;
  std::array<PanelTarget, 2> panels_;
  std::vector<CellMap> cell_maps_;  // of both eyes, where the warp asks for the poses of cells
  std::int64_t images_ = 0;
  gpu::CommandList commands_;
};

/// One byte per panel pixel of an eye: 1 where the eye sees it.
std::vector<std::uint8_t> visible_pixels(const Headset& headset, sim::Eye eye);

}  // namespace brace
