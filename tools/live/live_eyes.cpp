#include "tools/live/live_eyes.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hmd_sim/tracker.hpp"
#include "runtime/replay/scene_activation.hpp"

namespace brace {

namespace {

std::shared_ptr<SceneOnDevice> load_for(const gpu::Device& device, const ReplayOptions& options,
                                        const Session& session, const Headset& headset,
                                        const VolumePlacement& placement, const SceneOnDevice* volume_of) {
  return load_scene(device, session, options, headset, placement, volume_of);
}

}  // namespace

LiveEyes::State::State(const gpu::Device& device, const ReplayOptions& options, Read read,
                       const Pose& first_pose, const State* before, Keep keep)
    : session(std::move(read.session)),
      stages(std::move(read.stages)),
      headset(make_headset(session, options.data_folder)),
      placement(place_volume(session.scene, first_pose)),
      scene(keep == Keep::scene
                ? before->scene
                : load_for(device, options, session, headset, placement,
                           keep == Keep::volume && same_volume(session, before->session) ? before->scene.get()
                                                                                         : nullptr)),
      renderer(device, session, headset, *scene, placement, options.data_folder, EyeRenderer::Counting::on,
               nullptr, EyeRenderer::SecondEye::as_session, EyeRenderer::Layers::as_session,
               EyeRenderer::RayHeat::none, EyeRenderer::History::as_session),
      display(device, headset, session.pipeline.at("warp"), options.no_warp,
              scene_activation(device, session, headset, *scene, placement), options.data_folder),
      eyes(make_eye_pair(device, session, headset)),
      predict(live_stage(session.pipeline.at("predict"))),
      control(live_stage(session.pipeline.at("control"))) {}

LiveEyes::LiveEyes(const gpu::Device& device, const ReplayOptions& options, ReadSession read,
                   const Pose& first_pose)
    : device_(device),
      options_(options),
      read_(std::move(read)),
      first_pose_(first_pose),
      now_(std::make_unique<State>(device, options, read_(), first_pose, nullptr, State::Keep::nothing)),
      volume_stamps_(volume_stamps()),
      scene_stamps_(scene_stamps()),
      kernel_stamps_(kernel_stamps()) {}

LiveEyes::Times LiveEyes::show(const Pose& render_pose, const std::function<Pose()>& warp_pose) {
  EyeRenderer* const of_view = now_->view ? now_->view->renderer() : nullptr;
  EyeRenderer& renderer = of_view != nullptr ? *of_view : now_->renderer;
  render_pose_ = render_pose;
  const JobOutcome cast = renderer.render(render_pose, now_->eyes, now_->quality);
  warp_pose_ = warp_pose();
  const JobOutcome warp = now_->display.show({now_->eyes, render_pose, warp_pose_});
  const EyeRenderer::StepTimes& steps = renderer.step_times();
  return {to_s(steps.opening) * 1e3, to_s(steps.cast) * 1e3, to_s(steps.closing) * 1e3,
          to_s(warp.device_time) * 1e3, cast.work};
}

Pose LiveEyes::predicted(std::span<const brace_tracker_sample> readings, SimTime target) const {
  const NativeStage& stage = now_->predict;
  brace_pose pose{};
  const brace_result result = stage.predict_functions().predict(
      stage.self(), readings.data(), static_cast<std::uint32_t>(readings.size()), to_ns(target), &pose);
  const Pose found = sim::from_abi(pose);
  const double norm = glm::length(found.orientation);
  if (result != BRACE_OK || !(std::abs(norm - 1.0) < 1e-6) || !std::isfinite(glm::length(found.position)))
    throw device_error(
        "{} failed in predict; expected BRACE_OK and a finite unit pose; found result {}, |q| = {}",
        stage.place(), static_cast<int>(result), norm);
  return found;
}

void LiveEyes::control(SimDuration cast, SimDuration budget, std::int64_t missed) {
  State& state = *now_;
  const brace_control_input input{.struct_size = sizeof(brace_control_input),
                                  .frame = state.frame++,
                                  .frame_cost_ns = to_ns(cast),
                                  .budget_ns = std::max<std::int64_t>(to_ns(budget), 1),
                                  .missed = static_cast<std::uint32_t>(missed),
                                  .delay_frames = 0};
  double quality = 0.0;
  const brace_result result =
      state.control.control_functions().update(state.control.self(), &input, &quality);
  if (result != BRACE_OK || !(quality > 0.0 && quality <= 1.0))
    throw device_error(
        "{} failed in update; expected BRACE_OK and 0 < quality <= 1; found result {}, quality {}",
        state.control.place(), static_cast<int>(result), quality);
  state.quality = quality;
}

PanelPair LiveEyes::viewed(PanelPair shown) {
  if (!now_->view) return shown;
  return now_->view->make(shown, now_->eyes, render_pose_, warp_pose_);
}

std::unique_ptr<LiveView> LiveEyes::make_view(State& state, ViewKind kind) const {
  if (kind == ViewKind::picture) return nullptr;
  return std::make_unique<LiveView>(
      LiveView::Inputs{device_, options_, state.session, state.headset, *state.scene, state.placement}, kind);
}

void LiveEyes::set_transfer(const TransferFunction& resolved) {
  edited_ = resolved;
  show_edited();
}

void LiveEyes::show_edited() {
  State& state = *now_;
  state.scene->versions.replace_first(*edited_);
  state.scene->show_transfer(device_, 0);
  state.renderer.transfer_changed();
  state.renderer.forget_first_hits();
  if (!state.view) return;
  if (EyeRenderer* const renderer = state.view->renderer()) renderer->transfer_changed();
  IdealPicture* const ideal = state.view->ideal();
  if (ideal == nullptr) return;
  if (ideal->has_own_scene()) {
    ideal->scene().versions.replace_first(*edited_);
    ideal->scene().show_transfer(device_, 0);
  }
  ideal->transfer_changed();
}

std::string LiveEyes::set_view(ViewKind kind) {
  try {
    now_->view = make_view(*now_, kind);
    if (edited_ && now_->view && now_->view->ideal() != nullptr) show_edited();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

namespace {

void add_stamp(std::vector<std::pair<std::filesystem::path, std::filesystem::file_time_type>>& stamps,
               const std::filesystem::path& file) {
  std::error_code none;
  const auto time = std::filesystem::last_write_time(file, none);
  if (!none) stamps.emplace_back(file, time);
}

}  // namespace

LiveEyes::Stamps LiveEyes::scene_stamps() const {
  Stamps stamps;
  add_stamp(stamps, session().file);
  add_stamp(stamps, session().scene.transfer_function);
  for (const auto& [family, chosen] : session().pipeline)
    add_stamp(stamps, chosen.stage.origin);
  add_stamp(stamps, session().pipeline.at("skip").stage.glsl_source);
  return stamps;
}

LiveEyes::Stamps LiveEyes::kernel_stamps() const {
  Stamps stamps;
  for (const auto& [family, chosen] : session().pipeline) {
    if (chosen.stage.glsl_source.empty()) continue;
    std::error_code none;
    for (const auto& entry :
         std::filesystem::directory_iterator(chosen.stage.glsl_source.parent_path(), none))
      add_stamp(stamps, entry.path());
  }
  return stamps;
}

LiveEyes::Stamps LiveEyes::volume_stamps() const {
  Stamps stamps;
  add_stamp(stamps, session().scene.volume);
  return stamps;
}

std::optional<std::string> LiveEyes::reload_if_saved() {
  Stamps volume = volume_stamps(), scene = scene_stamps(), kernels = kernel_stamps();
  const bool same_values = volume == volume_stamps_, same_scene = same_values && scene == scene_stamps_;
  if (same_scene && kernels == kernel_stamps_) return std::nullopt;
  volume_stamps_ = std::move(volume);
  scene_stamps_ = std::move(scene);
  kernel_stamps_ = std::move(kernels);
  if (!same_scene) edited_.reset();
  return make(same_scene ? State::Keep::scene : same_values ? State::Keep::volume : State::Keep::nothing);
}

std::string LiveEyes::remake() {
  return make(State::Keep::volume);
}

std::string LiveEyes::make(State::Keep keep) {
  try {
    auto next = std::make_unique<State>(device_, options_, read_(), first_pose_, now_.get(), keep);
    const ViewKind kind = view();
    now_ = std::move(next);
    if (edited_ && keep != State::Keep::scene) show_edited();
    (void)set_view(kind);
  } catch (const Error& error) {
    return error.what();
  }
  volume_stamps_ = volume_stamps();
  scene_stamps_ = scene_stamps();
  kernel_stamps_ = kernel_stamps();
  return {};
}

}  // namespace brace
