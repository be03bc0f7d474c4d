#pragma once

#include "runtime/mab/mab_braces.hpp"
#include "runtime/replay/single_pass.hpp"
#include "runtime/stereo/plane_resampler.hpp"
#include "runtime/stereo/stereo_layers.hpp"

namespace brace {

/// stereo/layers: by re-projection layers. With rays/mab the rays are those of the left eye's atlas, and what
/// is composed is the other eye's; texels whose rays the other's lacks get rays of their own.
class ByLayers final : public SinglePass {
 public:
  /// `kernels`: the session's; with its stereo stage's snippet unless the plan leaves layers out. `plain`:
  /// without.
  ByLayers(const Inputs& inputs, const StereoPlan& plan, const CastKernels& kernels,
           const CastKernels& plain);

  std::optional<JobOutcome> render(const Pose& world_from_head, const EyePair& into, double quality,
                                   const Cells* cells) override;
  void look_at(const glm::dvec3& gaze) override {
    if (mab_) mab_->look_at(gaze);
  }
  std::uint64_t rays_max() const override;
  std::string note() const override;

 private:
  /// Canted displays: both eyes' pictures on planes beside each other, and from there to the displays'.
  struct Rectified {
    Rectified(const Inputs& inputs, const Rectification& onto);
    Rectification planes;
    EyePair pictures;
    std::array<PlaneResampler, 2> resamplers;
  };
  RayGrid reference_grid() const { return mab_ ? mab_->grid(sim::Eye::left) : layers_.grid(); }
  CastArea reference_area() const;
  const RayBuffers& rays() const { return mab_ ? mab_->rays() : layers_.rays(); }
  void set_eye(const EyeTarget& target, const EyeView& view, const std::optional<RayGrid>& grid) const;
  CastPipeline::Resources resources_of(const EyeTarget& target, sim::Eye eye, bool emits,
                                       std::vector<gpu::Binding>& bindings) const;
  /// What an eye sees, `which`-th of those composed.
  void compose(sim::Eye eye, std::size_t which, const EyeView& view, const EyeTarget& into);
  WorkCounts work_of_frame(const Cells* cells);

  const Headset& headset_;
  const SceneOnDevice& scene_;
  VolumePlacement placement_;
  CastPipeline pipeline_;
  std::optional<Rectified> rectified_;
  std::unique_ptr<MabBraces> mab_;  // null unless the session's rays are rays/mab's
  StereoLayers layers_;
  std::optional<EyeTarget> middle_;  // where rays are cast from between the eyes
  std::optional<HoleRays> holes_;    // where pixels get rays of their own
  std::vector<gpu::Binding> cast_bindings_;
  std::array<std::vector<gpu::Binding>, 2> composed_bindings_;
  std::int64_t frames_ = 0, cast_twice_ = 0, fresh_rays_ = 0;
};

}  // namespace brace
