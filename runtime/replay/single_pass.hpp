#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/frame/frame_work.hpp"
#include "runtime/mab/mab_plan.hpp"
#include "runtime/raycast/segment_replay.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/scene.hpp"
#include "runtime/replay/scene_activation.hpp"
#include "runtime/stereo/stereo_plan.hpp"
#include "runtime/warp_layers/hole_rays.hpp"

namespace brace {

/// The pictures of both eyes, indexed by sim::Eye.
using EyePair = std::array<EyeTarget, 2>;

/// Whether the session's stereo stage is stereo/layers; whether it is stereo/novel_view.
bool is_by_layers(const Session& session);
bool is_by_novel_view(const Session& session);
/// Either: the left eye alone is ray cast.
inline bool is_single_pass(const Session& session) {
  return is_by_layers(session) || is_by_novel_view(session);
}

/// The session's rays/mab over the headset's eyes; empty for other stages.
std::optional<MabPlan> plan_mab(const Session& session, const Headset& headset);

/// Throws input_error for stages that a single pass cannot work with.
void require_single_pass(const Session& session);

/// Where a head's eyes are.
EyeViews views_of(const Headset& headset, const Pose& world_from_head);

/// Layers, near plane and memory of the session's stereo/layers; of canted displays on planes beside each
/// other. Throws input_error for stages that it cannot work with, headsets that no such planes show, and
/// layers that do not fit.
StereoPlan plan_single_pass(const gpu::Device& device, const Session& session, const Headset& headset,
                            const VolumeInfo& volume, const VolumePlacement& placement);

/// What stereo/novel_view takes; nothing is allocated.
struct NovelViewMemory {
  std::uint64_t bytes = 0;  // of the layers
  std::string summary;      // for the report
};
NovelViewMemory novel_view_memory(const Session& session, const Headset& headset);

/// The rays of a cell, its edges at whole rays: next to each other, cells leave none out and share none.
CastArea rays_of(const CellCuts::Area& cell, const CastArea& all);

/// Renders both eyes by casting the left one's rays alone.
class SinglePass {
 public:
  /// Everything must outlive it.
  struct Inputs {
    const gpu::Device& device;
    const Session& session;
    const Headset& headset;
    const SceneOnDevice& scene;
    const VolumePlacement& placement;
    const std::filesystem::path& data_folder;
    const std::optional<ActiveStage>& native_cast;  // empty where the kernels cast
  };
  SinglePass(const Inputs& inputs, const char* name)
      : device_(inputs.device),
        commands_(inputs.device, name),
        native_cast_(inputs.native_cast),
        replay_(inputs.device) {}
  virtual ~SinglePass() = default;

  /// Wants the cast in cells, which are cut out of its rays, each submitted by itself. Outcomes are as many
  /// as those of two eyes: what follows the cast comes in one piece, the last of them; those before it have
  /// no work.
  struct Cells {
    const CellCuts& cuts;
    std::vector<CellOutcome>& outcomes;
  };

  /// Empty: the volume is too near for this frame, which must be cast twice; nothing was done. `quality`, and
  /// where the eyes look: of those that cast rays/mab's.
  virtual std::optional<JobOutcome> render(const Pose& world_from_head, const EyePair& into, double quality,
                                           const Cells* cells) = 0;
  virtual void look_at(const glm::dvec3&) {}

  /// The most rays of any of its casts.
  virtual std::uint64_t rays_max() const = 0;

  /// For the report, e.g. how many frames were cast twice and why; "" if there is nothing to say.
  virtual std::string note() const = 0;

 protected:
  template <class Record>
  void step(const char* name, const Record& record) {
    commands_.begin_timing(name);
    record();
    commands_.barrier();
    commands_.end_timing();
  }
  SimDuration submit();
  /// Opening brace and cast of an area of rays as `view` sees them, segments told to whom they are for:
  /// submitted if there are cells or the cast is on the host, else only recorded.
  void cast_rays(const CastPipeline& pipeline, const CastPipeline::Resources& resources, const EyeView& view,
                 const CastArea& area, const Cells* cells);
  /// Rays of their own for what `holes` has marked.
  void cast_holes(const HoleRays& holes, const CastPipeline::Resources& resources, const EyeView& view);
  /// Submits what was recorded, in the middle of a frame.
  void submit_part() { earlier_ += submit(); }
  /// What cast_rays without cells has counted; what cast_holes has.
  WorkCounts counted_rays(const CastPipeline& pipeline) const;
  WorkCounts counted_holes(const HoleRays& holes) const;
  void reset_holes(const HoleRays& holes);
  /// For the report: how many rays per frame pixels got that nothing was known of.
  static std::string fresh_rays_note(std::int64_t rays, std::int64_t frames);
  static NovelView::Folders hole_folders(const Inputs& inputs) {
    return {inputs.data_folder / "glsl", inputs.data_folder / "kernels" / "warp_layers"};
  }
  /// Submits the rest of a frame; `work` of one without cells, or of what follows them.
  JobOutcome finish(const std::function<WorkCounts()>& work, const Cells* cells);

  const gpu::Device& device_;
  gpu::CommandList commands_;

 private:
  EyeCast eye_cast(const CastPipeline& pipeline, const CastPipeline::Resources& resources,
                   const EyeView& view) const;
  void cast_opened(const EyeCast& eye, const CastArea& area, WorkCounts& counted);

  const std::optional<ActiveStage>& native_cast_;
  SegmentReplay replay_;
  HostRays host_rays_;
  SimDuration earlier_{0};             // of the frame's submissions so far, cells apart
  WorkCounts rays_work_, holes_work_;  // counted by casts on the host
};

/// What of a session's work is done in single pass; `cast_kernels(true)` composes its stereo stage's snippet
/// in.
std::unique_ptr<SinglePass> make_single_pass(
    const SinglePass::Inputs& inputs, const std::function<CastKernels(bool with_snippet)>& cast_kernels);

}  // namespace brace
