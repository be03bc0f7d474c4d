#include "runtime/replay/by_layers.hpp"

#include "base/error.hpp"

namespace brace {

namespace {

std::unique_ptr<MabBraces> mab_of(const SinglePass::Inputs& in) {
  std::optional<MabPlan> plan = plan_mab(in.session, in.headset);
  return plan ? std::make_unique<MabBraces>(in.device, std::move(*plan)) : nullptr;
}

void append(std::vector<gpu::Binding>& to, std::span<const gpu::Binding> more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

ByLayers::Rectified::Rectified(const Inputs& in, const Rectification& onto)
    : planes(onto),
      pictures{EyeTarget(in.device, planes.width_px, planes.height_px),
               EyeTarget(in.device, planes.width_px, planes.height_px)},
      resamplers([&] {
        const EyeViews to = views_of(in.headset, Pose{}), from = planes.apply(to);
        const PlaneResampler::Folders folders{in.data_folder / "glsl", in.data_folder / "kernels" / "stereo"};
        return std::array{PlaneResampler(in.device, from.left, to.left, folders),
                          PlaneResampler(in.device, from.right, to.right, folders)};
      }()) {}

ByLayers::ByLayers(const Inputs& in, const StereoPlan& plan, const CastKernels& kernels,
                   const CastKernels& plain)
    : SinglePass(in, "single-pass stereo"),
      headset_(in.headset),
      scene_(in.scene),
      placement_(in.placement),
      pipeline_(in.device, kernels),
      mab_(mab_of(in)),
      layers_(in.device, in.session.pipeline.at("stereo"), plan,
              {in.data_folder / "glsl", in.data_folder / "kernels" / "stereo"}) {
  if (plan.rectification) rectified_.emplace(in, *plan.rectification);
  if (plan.settings.from_middle)
    middle_.emplace(in.device, in.headset.eye.width_px, in.headset.eye.height_px);
  if (middle_ && plan.rectification) middle_.emplace(in.device, plan.width_px, plan.height_px);
  if (!plan.settings.fresh_rays || plan.layers_left_out) return;
  const int across = mab_ ? mab_->rays().across : plan.width_px;
  const int down = mab_ ? mab_->rays().down : plan.height_px;
  holes_.emplace(in.device, plain, across, down, hole_folders(in),
                 mab_ ? HoleRays::Of::atlas : HoleRays::Of::pixels);
}

void ByLayers::set_eye(const EyeTarget& target, const EyeView& view,
                       const std::optional<RayGrid>& grid) const {
  CastPipeline::set_eye(device_, target, view, placement_, scene_.volume, scene_.transfer, grid);
}

CastArea ByLayers::reference_area() const {
  if (!mab_) return layers_.ray_area();
  const RayGrid grid = reference_grid();
  return {0, 0, grid.across, grid.down};
}

/// `bindings`: what the resources refer to.
CastPipeline::Resources ByLayers::resources_of(const EyeTarget& target, sim::Eye eye, bool emits,
                                               std::vector<gpu::Binding>& bindings) const {
  bindings.clear();
  append(bindings, scene_.skip_bindings());
  if (emits && !layers_.plan().layers_left_out) append(bindings, layers_.bindings());
  std::optional<RayGrid> grid;
  if (mab_) {
    append(bindings, mab_->bindings(eye));
    grid = mab_->grid(eye);
  }
  return {scene_.volume, scene_.transfer, rays(), target, bindings, scene_.skip_map(), grid};
}

std::optional<JobOutcome> ByLayers::render(const Pose& world_from_head, const EyePair& into, double quality,
                                           const Cells* cells) {
  EyeViews eyes = views_of(headset_, world_from_head);
  if (rectified_) eyes = rectified_->planes.apply(eyes);
  const EyeView reference = middle_ ? middle_of(eyes) : eyes.left;
  ++frames_;
  if (!layers_.begin_frame(reference, scene_.volume.info(), placement_)) {
    ++cast_twice_;
    return {};
  }
  if (mab_) mab_->set_quality(quality);
  const EyePair& pictures = rectified_ ? rectified_->pictures : into;
  const EyeTarget& cast_into = middle_ ? *middle_ : pictures[0];
  set_eye(cast_into, reference, reference_grid());
  for (const sim::Eye eye : sim::all_eyes) {
    if (eye == sim::Eye::left && !middle_) continue;
    set_eye(pictures[static_cast<std::size_t>(eye)], eye == sim::Eye::left ? eyes.left : eyes.right,
            mab_ ? std::optional(mab_->grid(eye)) : std::nullopt);
  }
  layers_.reset_counters();
  if (holes_) reset_holes(*holes_);
  const CastPipeline::Resources resources = resources_of(cast_into, sim::Eye::left, true, cast_bindings_);
  cast_rays(pipeline_, resources, reference, reference_area(), cells);
  if (middle_) {
    compose(sim::Eye::left, 0, eyes.left, pictures[0]);
  } else {
    step("closing", [&] {
      pipeline_.record_closing(commands_, resources, {0, 0, cast_into.width_px, cast_into.height_px});
    });
  }
  compose(sim::Eye::right, middle_ ? 1 : 0, eyes.right, pictures[1]);
  if (rectified_) {
    step("stereo", [&] {
      for (std::size_t eye = 0; eye < 2; ++eye)
        rectified_->resamplers[eye].record(commands_, pictures[eye], into[eye]);
    });
  }
  return finish([&] { return work_of_frame(cells); }, cells);
}

void ByLayers::compose(sim::Eye eye, std::size_t which, const EyeView& view, const EyeTarget& into) {
  StereoLayers::Composed composed{.target = into, .holes = holes_ ? &holes_->holes() : nullptr};
  if (mab_) {
    composed.atlas = &mab_->rays();
    composed.grid = mab_->grid(eye);
    composed.of_atlas = mab_->bindings(eye);
  }
  if (mab_ && holes_) {
    composed.colours = &holes_->composed_colours();
    composed.depths_m = &holes_->composed_depths_m();
  }
  step("stereo", [&] { layers_.record_composed(commands_, which, composed); });
  if (!holes_ && !mab_) return;
  const CastPipeline::Resources resources =
      resources_of(into, eye, false, composed_bindings_[static_cast<std::size_t>(eye)]);
  if (holes_) return cast_holes(*holes_, resources, view);
  step("stereo", [&] {
    pipeline_.record_closing(commands_, resources, {0, 0, into.width_px, into.height_px});
  });
}

std::uint64_t ByLayers::rays_max() const {
  const RayBuffers& all = rays();
  return static_cast<std::uint64_t>(all.across) * static_cast<std::uint64_t>(all.down);
}

WorkCounts ByLayers::work_of_frame(const Cells* cells) {
  WorkCounts work;
  if (cells == nullptr) work = counted_rays(pipeline_);
  const StereoLayers::Counts counts = layers_.counted();
  // In the texels of cost models, 8 bytes read and 8 written. Neighbours find the range of a ray, 8 bytes, in
  // the cache (assumed): it is written once and read once.
  const auto texel_bytes = static_cast<std::uint64_t>(layers_.plan().settings.bytes_per_texel);
  const CastArea area = reference_area();
  const auto rays = static_cast<std::uint64_t>(area.width * area.height) * (middle_ ? 2 : 1);
  work.texels = (std::uint64_t{counts.written} + counts.read) * texel_bytes / 16 + rays;
  if (rectified_) {  // each pixel of the displays read and written once
    const PictureSize& eye = headset_.eye;
    work.texels += 2u * static_cast<std::uint64_t>(eye.width_px) * static_cast<std::uint64_t>(eye.height_px);
  }
  if (holes_) {
    const WorkCounts fresh = counted_holes(*holes_);
    work += fresh;
    fresh_rays_ += static_cast<std::int64_t>(fresh.rays);
  }
  return work;
}

std::string ByLayers::note() const {
  const std::string fresh = holes_ ? fresh_rays_note(fresh_rays_, frames_ - cast_twice_) : "";
  if (cast_twice_ == 0) return fresh;
  return fresh + (fresh.empty() ? "" : "; ") +
         fmt::format(
             "{} of {} eye frames were ray cast twice: the volume was nearer than the layers allow ({}); a "
             "smaller "
             "near_m, or more layers, takes it",
             cast_twice_, frames_, layers_.plan().summary);
}

}  // namespace brace
