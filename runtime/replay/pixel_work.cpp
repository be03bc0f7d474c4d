#include "runtime/replay/pixel_work.hpp"

#include <utility>

#include <fmt/core.h>

#include "runtime/replay/series_facts.hpp"

namespace brace {

PixelWork::PixelWork(const Inputs& inputs)
    : in_(inputs),
      error_at_(inputs.session.output.error, inputs.vsyncs),
      pictures_at_(inputs.session.output.images, inputs.vsyncs),
      renderer_(inputs.device, inputs.session, inputs.headset, inputs.scene, inputs.placement,
                inputs.options.data_folder, EyeRenderer::Counting::on, inputs.watchdog,
                EyeRenderer::SecondEye::as_session, EyeRenderer::Layers::as_session,
                EyeRenderer::RayHeat::none, EyeRenderer::History::as_session),
      display_(
          inputs.device, inputs.headset, inputs.session.pipeline.at("warp"), inputs.options.no_warp,
          scene_activation(inputs.device, inputs.session, inputs.headset, inputs.scene, inputs.placement),
          inputs.options.data_folder, cells_have_poses(inputs.session.pipeline.at("schedule"))) {
  for (EyePair& slot : slots_)
    slot = make_eye_pair(inputs.device, inputs.session, inputs.headset);
  if (!error_at_.any()) return;
  const bool measures_time = in_.session.clock.cost == "measured" || in_.session.clock.wall;
  error_meter_.emplace(ErrorMeter::Inputs{
      in_.device, in_.headset,
      std::make_unique<IdealPicture>(in_.device, in_.session, in_.headset, in_.scene, in_.placement,
                                     in_.options),
      in_.ideals, [this](std::int64_t version) { show_transfer(version); }, measures_time});
}

JobOutcome PixelWork::show_transfer(std::int64_t version) {
  const JobOutcome outcome = in_.scene.show_transfer(in_.device, version);
  renderer_.transfer_changed();
  if (error_meter_ && !error_meter_->ideal().has_own_scene()) error_meter_->ideal().transfer_changed();
  return outcome;
}

JobOutcome PixelWork::update(const UpdateRequest& request) {
  return show_transfer(request.transfer_version);
}

JobOutcome PixelWork::cast(const CastRequest& request) {
  const EyePair& eyes = slots_[static_cast<std::size_t>(request.slot)];
  renderer_.look_at(request.gaze);
  if (request.cell_columns == 0) return renderer_.render(request.world_from_head, eyes, request.quality);
  return renderer_.render_cells(request.world_from_head, eyes, request.quality,
                                {request.cell_columns, request.cell_rows, request.cuts});
}

CellOutcome PixelWork::cast_cell(const CellRequest& request) {
  const CastRequest& frame = request.frame;
  const auto slot = static_cast<std::size_t>(frame.slot);
  CellPoses& poses = cell_poses_[slot];
  const auto per_eye =
      static_cast<std::size_t>(frame.cell_columns) * static_cast<std::size_t>(frame.cell_rows);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    poses.cuts[eye] = frame.cuts.empty() ? CellCuts(frame.cell_columns, frame.cell_rows) : frame.cuts[eye];
    poses.world_from_head[eye].resize(per_eye);
  }
  const auto cell = static_cast<std::size_t>(request.cell);
  poses.world_from_head[cell / per_eye][cell % per_eye] = frame.world_from_head;
  return renderer_.render_cell(frame.world_from_head, slots_[slot], request.cell,
                               {frame.cell_columns, frame.cell_rows, frame.cuts});
}

JobOutcome PixelWork::warp(const WarpRequest& request) {
  const EyePair& eyes = slots_[static_cast<std::size_t>(request.slot)];
  const JobOutcome outcome = display_.show(
      {eyes, request.render_world_from_head, request.warp_world_from_head, request.frame, request.vsync_index,
       request.warp_scan, &cell_poses_[static_cast<std::size_t>(request.slot)]});
  if (error_at_.any() || pictures_at_.any()) waiting_ = std::make_shared<const PanelPair>(display_.read());
  return outcome;
}

void PixelWork::show(const ShowRequest& request) {
  if (request.image_is_new) shown_ = std::exchange(waiting_, nullptr);
  if (pictures_at_.names(request.vsync_index)) keep_pictures(request.vsync_index);
  if (error_at_.names(request.vsync_index)) error_meter_->add(request, shown_);
}

void PixelWork::keep_pictures(std::int64_t vsync_index) {
  EyePicture picture{vsync_index, fmt::format("{}/{:06}_left.png", in_.picture_folder, vsync_index),
                     fmt::format("{}/{:06}_right.png", in_.picture_folder, vsync_index)};
  write_png(in_.run.path(picture.left_png), (*shown_)[0]);
  write_png(in_.run.path(picture.right_png), (*shown_)[1]);
  pictures_.push_back(std::move(picture));
}

}  // namespace brace
