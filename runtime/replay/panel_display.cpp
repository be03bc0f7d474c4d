#include "runtime/replay/panel_display.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/host/stage_glsl.hpp"
#include "runtime/replay/series_facts.hpp"

namespace brace {

namespace {

LensTraits headset_traits(const Headset& headset) {
  LensTraits traits =
      common_traits(lens_traits(headset.profile.eyes[0].lens), lens_traits(headset.profile.eyes[1].lens));
  if (lens_does_nothing(headset)) {
    // With all coefficients zero, Brown-Conrady is the identity, computed.
    const bool computed = headset.distort_always && traits.kind == sim::LensKind::identity;
    if (computed) traits.kind = sim::LensKind::brown_conrady;
    if (!headset.distort_always) traits.kind = sim::LensKind::identity;
  }
  if (headset.fetch_channels_always) traits.one_fetch = false;
  return traits;
}

gpu::KernelDescription display_kernel(const PipelineStage& warp, const LensTraits& lens,
                                      const std::filesystem::path& data_folder, bool cell_poses) {
  const std::array<const PipelineStage*, 1> stages = {&warp};
  StageGlsl glsl = stage_glsl(stages);
  DisplayParts parts;
  parts.glsl_folder = data_folder / "glsl";
  parts.kernels_folder = data_folder / "kernels";
  parts.stages = std::move(glsl.resolve);
  parts.constants = std::move(glsl.constants);
  parts.lens = lens;
  parts.cell_poses = cell_poses;
  parts.counters =
      std::find(warp.stage.inputs.begin(), warp.stage.inputs.end(), "depth") != warp.stage.inputs.end();
  return compose_display_kernel(parts);
}

PanelTarget::SceneRange range_of(const NovelView::Box& box, const Pose& world_from_eye) {
  const glm::dvec3 eye = compose(inverse(box.world_from_volume), world_from_eye).position;
  glm::dvec3 to_near, to_far;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * box.edges_m[static_cast<std::size_t>(axis)];
    to_near[axis] = std::max(std::abs(eye[axis]) - half, 0.0);
    to_far[axis] = std::abs(eye[axis]) + half;
  }
  return {glm::length(to_near), glm::length(to_far)};
}

/// Of all these eyes; a little wider than the box, as depths are floats.
PanelTarget::SceneRange range_of(const NovelView::Box& box, std::span<const Pose> world_from_eyes) {
  PanelTarget::SceneRange all = range_of(box, world_from_eyes.front());
  for (const Pose& world_from_eye : world_from_eyes) {
    const PanelTarget::SceneRange one = range_of(box, world_from_eye);
    all = {std::min(all.nearest_m, one.nearest_m), std::max(all.farthest_m, one.farthest_m)};
  }
  return {all.nearest_m * 0.999, all.farthest_m * 1.001};
}

}  // namespace

PanelDisplay::PanelDisplay(const gpu::Device& device, const Headset& headset, const PipelineStage& warp,
                           const std::filesystem::path& data_folder)
    : PanelDisplay(device, headset, warp, false, data_folder) {}

PanelDisplay::PanelDisplay(const gpu::Device& device, const Headset& headset, const PipelineStage& warp,
                           bool cell_poses, const std::filesystem::path& data_folder)
    : device_(device),
      headset_(headset),
      lens_(headset_traits(headset)),
      by_line_(warps_by_line(warp)),
      pipeline_(device, display_kernel(warp, lens_, data_folder, cell_poses)),
      commands_(device, "panels") {
  for (const sim::Eye eye : sim::all_eyes) {
    panels_[static_cast<std::size_t>(eye)] =
        PanelTarget(device, panel_eye(headset, eye), source_picture(headset, eye));
    if (cell_poses) cell_maps_.emplace_back(device, headset.eye.width_px, headset.eye.height_px);
  }
}

PanelDisplay::PanelDisplay(const gpu::Device& device, const Headset& headset, const PipelineStage& warp,
                           const PipelineStage& no_warp, const ActivationInput& activation,
                           const std::filesystem::path& data_folder, bool cells_have_poses)
    : PanelDisplay(device, headset, warp.stage.native != nullptr || takes_layers(warp) ? no_warp : warp,
                   cells_have_poses && warp_pose_of(warp) != WarpPose::none, data_folder) {
  if (warp.stage.native != nullptr) native_warp_.emplace(device, warp, activation, headset.eye);
  by_line_ = warps_by_line(warp);
  box_ = box_of(activation);
  if (takes_layers(warp)) layered_.emplace(device, warp, activation, headset, data_folder);
}

void PanelDisplay::set_eye(const PanelImage& image, sim::Eye eye, const ScanPoses& scan) {
  const auto i = static_cast<std::size_t>(eye);
  const Pose& head_from_eye = headset_.profile.eye(eye).head_from_eye;
  const ScanEye now{compose(scan.first_line, head_from_eye), compose(scan.last_line, head_from_eye)};
  std::vector<Pose> then = {compose(image.render_world_from_head, head_from_eye)};
  if (!cell_maps_.empty()) {
    BRACE_CHECK(image.cell_poses != nullptr);
    for (const Pose& world_from_head : image.cell_poses->world_from_head[i])
      then.push_back(compose(world_from_head, head_from_eye));
    cell_maps_[i].set(image.cell_poses->cuts[i], std::span(then).subspan(1), now);
  }
  if (box_) panels_[i].set_scene_range(range_of(*box_, then));
  panels_[i].set_poses(device_, then.front(), now);
}

JobOutcome PanelDisplay::show(const PanelImage& image) {
  ++images_;
  commands_.reset();
  commands_.begin_timing("display");
  ScanPoses scan{image.warp_world_from_head, image.warp_world_from_head};
  if (by_line_ && image.warp_scan) scan = *image.warp_scan;
  for (const sim::Eye eye : sim::all_eyes) {
    const auto i = static_cast<std::size_t>(eye);
    set_eye(image, eye, scan);
    const EyeWarp warp{
        eye, image.render_world_from_head, image.warp_world_from_head, image.frame, image.vsync_index, scan};
    if (native_warp_) native_warp_->record(commands_, headset_, warp, image.eyes[i]);
    if (layered_) layered_->record(commands_, headset_, warp, image.eyes[i]);
    std::vector<gpu::Binding> more;
    if (pipeline_.uses_depth())
      more.push_back(gpu::bind(DisplaySlot::source_depth, image.eyes[i].depth_texels));
    if (!cell_maps_.empty())
      for (const gpu::Binding& binding : cell_maps_[i].bindings())
        more.push_back(binding);
    pipeline_.record(commands_, panels_[i],
                     native_warp_ ? native_warp_->picture(eye)
                     : layered_   ? layered_->picture(eye)
                                  : image.eyes[i].image_texels,
                     more);
  }
  commands_.end_timing();
  commands_.barrier();
  const SimDuration time(gpu::device_ns(gpu::submit_and_wait(commands_), "display"));
  if (layered_) layered_->take_counts();
  return {work(), time};
}

DisplayPipeline::Counts PanelDisplay::counted() const {
  if (layered_) return {layered_->counts().uncovered, layered_->counts().filled};
  return pipeline_.counted(device_);
}

PanelPair PanelDisplay::read() const {
  return {panels_[0].read(device_), panels_[1].read(device_)};
}

WorkCounts PanelDisplay::work() const {
  WorkCounts work;
  for (const PanelTarget& panel : panels_)
    work.texels += panel.pixels_written();
  if (native_warp_)
    work.texels += 2 * static_cast<std::uint64_t>(headset_.eye.width_px) *
                   static_cast<std::uint64_t>(headset_.eye.height_px);
  if (layered_) work.texels += layered_->texels();
  return work;
}

std::vector<std::uint8_t> visible_pixels(const Headset& headset, sim::Eye eye) {
  const sim::EyeProfile& profile = headset.profile.eye(eye);
  const sim::HiddenAreaMask mask =
      sim::hidden_area_mask(profile.lens, profile.fov, {headset.panel.width_px, headset.panel.height_px},
                            {headset.eye.width_px, headset.eye.height_px});
  std::vector<std::uint8_t> visible;
  visible.reserve(mask.panel.pixels.size());
  for (const std::uint8_t hidden : mask.panel.pixels)
    visible.push_back(hidden == 0 ? 1 : 0);
  return visible;
}

}  // namespace brace
