#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/frame/frame_work.hpp"
#include "runtime/mab/mab_braces.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/scene.hpp"
#include "runtime/stereo/plane_resampler.hpp"
#include "runtime/stereo/stereo_layers.hpp"
#include "runtime/warp_layers/hole_rays.hpp"
#include "runtime/warp_layers/novel_view.hpp"

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
  };
  explicit SinglePass(const gpu::Device& device, const char* name)
      : device_(device), commands_(device, name) {}
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
  /// Opening brace and cast of an area of rays, submitted if there are cells, else only recorded.
  void cast_rays(const CastPipeline& pipeline, const CastPipeline::Resources& resources, const CastArea& area,
                 const Cells* cells);
  /// Submits what was recorded after cast_rays; `work` of a frame without cells, or of what follows them.
  JobOutcome finish(const std::function<WorkCounts()>& work, const Cells* cells);

  const gpu::Device& device_;
  gpu::CommandList commands_;
};

/// stereo/layers: by re-projection layers.
class ByLayers final : public SinglePass {
 public:
  /// `kernels`: the session's; with its stereo stage's snippet unless the plan leaves layers out. `plain`:
  /// without.
  ByLayers(const Inputs& inputs, const StereoPlan& plan, const CastKernels& kernels,
           const CastKernels& plain);

  std::optional<JobOutcome> render(const Pose& world_from_head, const EyePair& into, double quality,
                                   const Cells* cells) override;
  std::string note() const override;

 private:
  /// Canted displays: both eyes' pictures on planes beside each other, and from there to the displays'.
  struct Rectified {
    Rectified(const Inputs& inputs, const Rectification& onto);
    Rectification planes;
    EyePair pictures;
    std::array<PlaneResampler, 2> resamplers;
  };
  void record_second_eye(const EyeTarget& left, const EyeTarget& right);
  WorkCounts work_of_frame(const Cells* cells);

  const Headset& headset_;
  const SceneOnDevice& scene_;
  VolumePlacement placement_;
  CastPipeline pipeline_;
  std::optional<Rectified> rectified_;
  StereoLayers layers_;
  std::optional<HoleRays> holes_;  // where pixels get rays of their own
  std::vector<gpu::Binding> bindings_;
  std::int64_t frames_ = 0, cast_twice_ = 0, fresh_rays_ = 0;
};

/// stereo/novel_view: by layers of emission and absorption along the left eye's rays (runtime/warp_layers).
/// With rays/mab these are the rays of an atlas over that eye's picture and what is beside it.
class ByNovelView final : public SinglePass {
 public:
  /// `kernels`: the session's with its stereo stage's snippet; `plain`: without, and a ray per pixel. Throws
  /// input_error as plan_single_pass does, and for layers that the device cannot hold.
  ByNovelView(const Inputs& inputs, const CastKernels& kernels, const CastKernels& plain);

  std::optional<JobOutcome> render(const Pose& world_from_head, const EyePair& into, double quality,
                                   const Cells* cells) override;
  void look_at(const glm::dvec3& gaze) override {
    if (mab_) mab_->look_at(gaze);
  }
  std::string note() const override;

 private:
  RayGrid ray_grid() const { return mab_ ? mab_->grid(sim::Eye::left) : grid_; }
  void bind();
  CastPipeline::Resources resources_of(const EyeTarget& target) const;
  LayerSource layer_source_of(const EyeView& reference) const;
  void cut_out(const EyeTarget& into);
  WorkCounts work_of_frame(const Cells* cells);
  /// What an eye sees, with fresh rays for what is not known.
  void record_view(const EyeView& reference, const EyeView& eye, const EyeTarget& into);

  const Headset& headset_;
  const SceneOnDevice& scene_;
  VolumePlacement placement_;
  bool middle_;  // both eyes are views from between them; else the left one is cast
  RayGrid grid_;
  std::unique_ptr<MabBraces> mab_;  // null unless the session's rays are rays/mab's
  EyeTarget wide_;                  // with it: the cast eye's picture and what is beside it, with its layers
  CastPipeline pipeline_;
  RayBuffers rays_;     // of the grid; with rays/mab of pixels with rays of their own alone
  gpu::Buffer layers_;  // empty with rays/mab
  NovelView view_;
  HoleRays holes_;
  NovelView::Box box_;
  std::vector<gpu::Binding> bindings_;
  std::int64_t frames_ = 0, fresh_rays_ = 0;
  std::optional<EyeTarget> reference_;  // of the middle
};

/// What of a session's work is done in single pass; `cast_kernels(true)` composes its stereo stage's snippet
/// in.
std::unique_ptr<SinglePass> make_single_pass(
    const SinglePass::Inputs& inputs, const std::function<CastKernels(bool with_snippet)>& cast_kernels);

}  // namespace brace
