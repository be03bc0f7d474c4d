#pragma once

#include "runtime/mab/mab_braces.hpp"
#include "runtime/replay/single_pass.hpp"

namespace brace {

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
  std::uint64_t rays_max() const override;
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

}  // namespace brace
