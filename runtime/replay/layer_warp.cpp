#include "runtime/replay/layer_warp.hpp"

#include "runtime/replay/scan_line_rays.hpp"
#include "runtime/replay/series_facts.hpp"

namespace brace {

NovelView::Box box_of(const ActivationInput& input) {
  NovelView::Box box{input.world_from_volume, box_size(*input.volume)};
  for (double& edge : box.edges_m)
    edge *= input.metres_per_unit / voxel_length(*input.volume);
  return box;
}

LayerWarp::LayerWarp(const gpu::Device& device, const PipelineStage& warp, const ActivationInput& input,
                     const Headset& headset, const std::filesystem::path& data_folder)
    : device_(device),
      warp_(warp),
      data_folder_(data_folder),
      box_(box_of(input)),
      pictures_(make_eye_pair(device, headset.eye)),
      pixels_(2 * static_cast<std::uint64_t>(headset.eye.width_px) *
              static_cast<std::uint64_t>(headset.eye.height_px)) {
  if (!warps_by_line(warp)) return;
  for (const sim::Eye eye : sim::all_eyes)
    scan_fractions_[static_cast<std::size_t>(eye)] = scan_fraction_buffer(device, headset, eye);
}

void LayerWarp::record(gpu::CommandList& commands, const Headset& headset, const EyeWarp& warp,
                       const EyeTarget& from) {
  const auto i = static_cast<std::size_t>(warp.eye);
  if (!views_[i]) {
    const NovelView::Folders folders{data_folder_ / "glsl", data_folder_ / "kernels" / "warp_layers"};
    views_[i].emplace(device_, warp_, folders, static_cast<bool>(from.layer_rays));
  }
  const LayerSource source = layer_source(from, eye_view(headset, warp.eye, warp.render_world_from_head));
  const EyeView now = eye_view(headset, warp.eye, warp.warp_world_from_head);
  if (!scan_fractions_[i]) {
    views_[i]->record(commands, source, now, pictures_[i], box_);
    return;
  }
  const Pose& head_from_eye = headset.profile.eye(warp.eye).head_from_eye;
  views_[i]->record_by_line(commands, source, now,
                            {compose(warp.warp_scan.first_line, head_from_eye),
                             compose(warp.warp_scan.last_line, head_from_eye), scan_fractions_[i]},
                            pictures_[i], box_);
}

void LayerWarp::take_counts() {
  texels_ = pixels_;
  for (const std::optional<NovelView>& view : views_) {
    const NovelView::Counts counts = view->counted();
    view->reset_counters();
    texels_ += counts.segments;
    counts_.segments += counts.segments;
    counts_.uncovered += counts.uncovered;
    counts_.filled += counts.filled;
  }
}

}  // namespace brace
