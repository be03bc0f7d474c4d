#include "runtime/replay/pixel_work.hpp"

#include <limits>

#include <fmt/core.h>

#include "base/error.hpp"
#include "runtime/metrics/image_error.hpp"
#include "runtime/replay/cast_integrator.hpp"

namespace brace {

namespace {

/// The session of ideal pictures: lit as asked for, a ray per pixel, and where the session asks for them
/// converged ones.
Session ideal_session(Session session, const PipelineStage& rays) {
  session.pipeline.at("rays") = rays;
  session.scene.shading = session.plan.shading;
  if (!session.output.converged_ideal) return session;
  if (const auto converged = converged_session(session)) return *converged;
  throw input_error(
      "{}: output.ideal = 'converged' is made by cast/dvr; accepted with pipeline.cast = '{}': session",
      session.file.string(), session.pipeline.at("cast").stage.name);
}

std::unique_ptr<SceneOnDevice> scene_of_ideal(const PixelWork::Inputs& in, const Session& session) {
  if (!session.output.converged_ideal) return nullptr;
  ReplayOptions options = in.options;
  options.messages = false;
  return load_scene(in.device, session, options, in.headset, in.placement);
}

}  // namespace

PixelWork::Ideal::Ideal(const Inputs& in)
    : session(ideal_session(in.session, in.options.full_rate)),
      own_scene(scene_of_ideal(in, session)),
      scene(own_scene ? *own_scene : in.scene),
      renderer(in.device, session, in.headset, scene, in.placement, in.options.data_folder,
               EyeRenderer::Counting::off, nullptr, EyeRenderer::SecondEye::ray_cast),
      display(in.device, in.headset, in.options.no_warp, in.options.data_folder),
      eyes(make_eye_pair(in.device, in.headset.eye)) {}

PixelWork::PixelWork(const Inputs& inputs)
    : in_(inputs),
      error_at_(inputs.session.output.error, inputs.vsyncs),
      pictures_at_(inputs.session.output.images, inputs.vsyncs),
      renderer_(inputs.device, inputs.session, inputs.headset, inputs.scene, inputs.placement,
                inputs.options.data_folder, EyeRenderer::Counting::on, inputs.watchdog,
                EyeRenderer::SecondEye::as_session, EyeRenderer::Layers::as_session),
      display_(
          inputs.device, inputs.headset, inputs.session.pipeline.at("warp"), inputs.options.no_warp,
          scene_activation(inputs.device, inputs.session, inputs.headset, inputs.scene, inputs.placement),
          inputs.options.data_folder) {
  for (EyePair& slot : slots_)
    slot = make_eye_pair(inputs.device, inputs.session, inputs.headset);
  if (!error_at_.any()) return;
  ideal_.emplace(in_);
  for (const sim::Eye eye : sim::all_eyes) {
    visible_[static_cast<std::size_t>(eye)] = visible_pixels(in_.headset, eye);
  }
}

JobOutcome PixelWork::show_transfer(std::int64_t version) {
  const JobOutcome outcome = in_.scene.show_transfer(in_.device, version);
  renderer_.transfer_changed();
  if (ideal_ && !ideal_->own_scene) ideal_->renderer.transfer_changed();
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

void PixelWork::show_ideal_transfer(std::int64_t version) {
  if (ideal_->scene.transfer_version == version) return;
  if (!ideal_->own_scene) {
    show_transfer(version);
    return;
  }
  ideal_->scene.show_transfer(in_.device, version);
  ideal_->renderer.transfer_changed();
}

ShowOutcome PixelWork::measure_error(const ShowRequest& request) {
  const Pose& true_world_from_head = request.true_world_from_head;
  const std::int64_t shown_version = in_.scene.transfer_version;
  show_ideal_transfer(request.transfer_version);
  ideal_->renderer.render(true_world_from_head, ideal_->eyes);
  ideal_->display.show({ideal_->eyes, true_world_from_head, true_world_from_head});
  const PanelPair ideal = ideal_->display.read();
  if (!ideal_->own_scene) show_ideal_transfer(shown_version);  // what is cast next still shows it
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
