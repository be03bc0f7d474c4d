// The frames of eye_renderer.hpp that are cast in cells.
#include "runtime/raycast/native_steps.hpp"
#include "runtime/replay/eye_renderer.hpp"

namespace brace {

CellOutcome EyeRenderer::cast_cell(sim::Eye eye, const EyeView& view,
                                   const CastPipeline::Resources& resources, const CastArea& area) {
  CellOutcome cell;
  if (area.width == 0 || area.height == 0) return cell;
  pipeline_.reset_counters(device_);
  const EyeCast whole = eye_cast(eye, view, resources);
  if (native_cast_ && (*native_cast_)->casts_on_host()) {
    cell.device_time = cast_on_host(whole, area, host_rays_, cell.work, commands_);
    return cell;
  }
  cell.device_time = submit_step("cast", [&] {
    if (native_cast_) {
      (*native_cast_)->cast(cast_frame(whole, commands_.hand_out(), area));
    } else {
      pipeline_.record_cast(commands_, resources, area);
    }
  });
  cell.work = pipeline_.counted(device_);
  return cell;
}

JobOutcome EyeRenderer::render_cells(const Pose& world_from_head, const EyePair& into, double quality,
                                     const Cells& cells) {
  const CellCuts even(cells.columns, cells.rows);
  if (single_pass_) {
    const SinglePass::Cells of_single_pass{cells.cuts.empty() ? even : cells.cuts[0], cells_};
    if (const std::optional<JobOutcome> outcome =
            single_pass_->render(world_from_head, into, quality, &of_single_pass))
      return *outcome;
  }
  if (mab_) mab_->set_quality(quality);
  cells_.clear();
  for (const sim::Eye eye : sim::all_eyes) {
    const EyeTarget& target = into[static_cast<std::size_t>(eye)];
    const EyeView view = eye_view(headset_, eye, world_from_head);
    set_eye(eye, view, target);
    const CastPipeline::Resources resources = resources_of(eye, target, rays());
    const CastArea all{0, 0, resources.rays_across(), resources.rays_down()};
    const std::size_t first = cells_.size();
    const EyeCast whole = eye_cast(eye, view, resources);
    const SimDuration opening = open(whole, all);
    const CellCuts& cuts = cells.cuts.empty() ? even : cells.cuts[static_cast<std::size_t>(eye)];
    for (int i = 0; i < cuts.columns * cuts.rows; ++i)
      cells_.push_back(cast_cell(eye, view, resources, rays_of(cuts.area(i), all)));
    const SimDuration closing = close(whole, {0, 0, target.width_px, target.height_px});
    cells_[first].device_time += opening;
    cells_.back().device_time += closing;
    if (keeps_first_hits_) {
      commands_.reset();
      keep_first_hits(commands_, eye, target);
      cells_.back().device_time += SimDuration(gpu::total_ns(gpu::submit_and_wait(commands_)));
    }
  }
  ++frame_;
  JobOutcome outcome{.cells = cells_};
  for (const CellOutcome& cell : cells_) {
    outcome.work += cell.work;
    outcome.device_time += cell.device_time;
  }
  return outcome;
}

CellOutcome EyeRenderer::render_cell(const Pose& world_from_head, const EyePair& into, int number,
                                     const Cells& cells) {
  const int per_eye = cells.columns * cells.rows;
  const auto i = static_cast<std::size_t>(number / per_eye);
  const CellCuts even(cells.columns, cells.rows);
  const CellCuts& cuts = cells.cuts.empty() ? even : cells.cuts[i];
  const EyeTarget& target = into[i];
  const auto eye = static_cast<sim::Eye>(i);
  const CastArea area = rays_of(cuts.area(number % per_eye), {0, 0, target.width_px, target.height_px});
  if (area.width == 0 || area.height == 0) return {};
  const EyeView view = eye_view(headset_, eye, world_from_head);
  set_eye(eye, view, target);
  const CastPipeline::Resources resources = resources_of(eye, target, rays());
  if (native_cast_) {
    const EyeCast whole = eye_cast(eye, view, resources);
    const SimDuration opening = open(whole, area);
    CellOutcome cell = cast_cell(eye, view, resources, area);
    cell.device_time += opening;
    cell.device_time += close(whole, area);
    return cell;
  }
  pipeline_.reset_counters(device_);
  CellOutcome cell;
  cell.device_time = submit_step("cell", [&] {
    pipeline_.record_opening(commands_, resources, area);
    commands_.barrier();
    pipeline_.record_cast(commands_, resources, area);
    commands_.barrier();
    pipeline_.record_closing(commands_, resources, area);
  });
  cell.work = pipeline_.counted(device_);
  return cell;
}

}  // namespace brace
