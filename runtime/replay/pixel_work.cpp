#include "runtime/replay/pixel_work.hpp"

#include <limits>

#include <fmt/core.h>

#include "runtime/metrics/image_error.hpp"

namespace brace {

namespace {

Session with_rays(Session session, const PipelineStage& rays) {
  session.pipeline.at("rays") = rays;
  return session;
}

}  // namespace

PixelWork::Ideal::Ideal(const Inputs& in)
    : session(with_rays(in.session, in.full_rate)),
      renderer(in.device, session, in.headset, in.scene, in.placement, in.data_folder,
               EyeRenderer::Counting::off, nullptr, EyeRenderer::SecondEye::ray_cast),
      display(in.device, in.headset, in.no_warp, in.data_folder),
      eyes(make_eye_pair(in.device, in.headset.eye)) {}

PixelWork::PixelWork(const Inputs& inputs)
    : in_(inputs),
      error_at_(inputs.session.output.error, inputs.vsyncs),
      pictures_at_(inputs.session.output.images, inputs.vsyncs),
      renderer_(inputs.device, inputs.session, inputs.headset, inputs.scene, inputs.placement,
                inputs.data_folder, EyeRenderer::Counting::on, inputs.watchdog),
      display_(
          inputs.device, inputs.headset, inputs.session.pipeline.at("warp"), inputs.no_warp,
          scene_activation(inputs.device, inputs.session, inputs.headset, inputs.scene, inputs.placement),
          inputs.data_folder) {
  for (EyePair& slot : slots_)
    slot = make_eye_pair(inputs.device, inputs.headset.eye);
  if (!error_at_.any()) return;
  ideal_.emplace(in_);
  for (const sim::Eye eye : sim::all_eyes) {
    visible_[static_cast<std::size_t>(eye)] = visible_pixels(in_.headset, eye);
  }
}

JobOutcome PixelWork::show_transfer(std::int64_t version) {
  const JobOutcome outcome = in_.scene.show_transfer(in_.device, version);
  renderer_.transfer_changed();
  if (ideal_) ideal_->renderer.transfer_changed();
  return outcome;
}

JobOutcome PixelWork::update(const UpdateRequest& request) {
  return show_transfer(request.transfer_version);
}

JobOutcome PixelWork::cast(const CastRequest& request) {
  const EyePair& eyes = slots_[static_cast<std::size_t>(request.slot)];
  if (request.cell_columns == 0) return renderer_.render(request.world_from_head, eyes, request.quality);
  return renderer_.render_cells(request.world_from_head, eyes, request.quality, request.cell_columns,
                                request.cell_rows);
}

JobOutcome PixelWork::warp(const WarpRequest& request) {
  const EyePair& eyes = slots_[static_cast<std::size_t>(request.slot)];
  const JobOutcome outcome =
      display_.show({eyes, request.render_world_from_head, request.warp_world_from_head, request.frame,
                     request.vsync_index});
  if (error_at_.any() || pictures_at_.any()) waiting_ = display_.read();
  return outcome;
}

ShowOutcome PixelWork::show(const ShowRequest& request) {
  if (request.image_is_new) std::swap(shown_, waiting_);
  if (pictures_at_.names(request.vsync_index)) keep_pictures(request.vsync_index);
  if (error_at_.names(request.vsync_index)) return measure_error(request);
  const double none = std::numeric_limits<double>::quiet_NaN();
  return {none, none};
}

ShowOutcome PixelWork::measure_error(const ShowRequest& request) {
  const Pose& true_world_from_head = request.true_world_from_head;
  const std::int64_t shown_version = in_.scene.transfer_version;
  const bool differs = request.transfer_version != shown_version;
  if (differs) show_transfer(request.transfer_version);
  ideal_->renderer.render(true_world_from_head, ideal_->eyes);
  ideal_->display.show({ideal_->eyes, true_world_from_head, true_world_from_head});
  const PanelPair ideal = ideal_->display.read();
  if (differs) show_transfer(shown_version);  // what is cast next still shows it
  return {dssim_from_ssim(ssim(shown_[0], ideal[0], visible_[0])),
          dssim_from_ssim(ssim(shown_[1], ideal[1], visible_[1]))};
}

void PixelWork::keep_pictures(std::int64_t vsync_index) {
  EyePicture picture{vsync_index, fmt::format("{}/{:06}_left.png", in_.picture_folder, vsync_index),
                     fmt::format("{}/{:06}_right.png", in_.picture_folder, vsync_index)};
  write_png(in_.run.path(picture.left_png), shown_[0]);
  write_png(in_.run.path(picture.right_png), shown_[1]);
  pictures_.push_back(std::move(picture));
}

}  // namespace brace
