#include "runtime/replay/eye_renderer.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/host/stage_glsl.hpp"
#include "runtime/raycast/host_braces.hpp"
#include "runtime/raycast/volume_levels.hpp"
#include "runtime/replay/cast_integrator.hpp"
#include "runtime/replay/scene_shading.hpp"
#include "runtime/replay/series_facts.hpp"

namespace brace {

namespace {

/// The pictures that others are compared with are cast without levels from a scene that has them.
bool samples_levels(const Session& session, const SceneOnDevice& scene) {
  return scene.levels != nullptr && wants_levels(session.pipeline.at("cast"));
}

CastKernels session_kernels(const Session& session, const SceneOnDevice& scene, const PipelineStage& rays,
                            const VolumePlacement& placement, const std::filesystem::path& data_folder,
                            bool counters, bool emits, bool layers,
                            EyeRenderer::RayHeat heat = EyeRenderer::RayHeat::none) {
  std::vector<const PipelineStage*> stages = {&rays, &session.pipeline.at("cast"), &scene.skip_stage};
  if (emits) stages.push_back(&session.pipeline.at("stereo"));
  if (layers) stages.push_back(&session.pipeline.at("warp"));
  StageGlsl glsl = stage_glsl(stages);
  CastParts parts;
  parts.glsl_folder = data_folder / "glsl";
  parts.kernels_folder = data_folder / "kernels";
  parts.stages = std::move(glsl.resolve);
  parts.constants = std::move(glsl.constants);
  parts.phong = session.scene.shading == "phong";
  parts.sampled = sampled_shading(session.scene, placement, scene.step_units);
  parts.counters = counters;
  parts.layers_by_ray = (layers || (emits && is_by_novel_view(session))) && rays.stage.id() == "rays/mab";
  parts.native_rays = rays.stage.native != nullptr;
  parts.native_cast = is_native(session, "cast");
  parts.replays_segments = parts.native_cast && (layers || (emits && is_single_pass(session)));
  CastKernels kernels = compose_cast_kernels(parts, scene.volume);
  if (heat != EyeRenderer::RayHeat::none) {
    BRACE_CHECK(counters);
    kernels.cast.defines.emplace_back("BRACE_RAY_HEAT", heat == EyeRenderer::RayHeat::samples
                                                            ? "brace_count_samples"
                                                            : "brace_count_skip_steps");
  }
  if (samples_levels(session, scene)) {
    for (auto& define : scene.levels->defines())
      kernels.cast.defines.push_back(std::move(define));
  }
  return kernels;
}

bool is_occlusion(const PipelineStage& skip) {
  return skip.stage.id() == "skip/occlusion";
}

/// Of every renderer of a watched run: what one of them finds, the others survive.
std::uint64_t guard_bytes(const Session& session) {
  return session.run.watchdog == WatchdogLevel::full ? watchdog_guard_bytes : 0;
}

std::unique_ptr<MabBraces> make_mab(const gpu::Device& device, const Session& session,
                                    const Headset& headset) {
  std::optional<MabPlan> plan = plan_mab(session, headset);
  return plan ? std::make_unique<MabBraces>(device, std::move(*plan), guard_bytes(session)) : nullptr;
}

}  // namespace

EyePair make_eye_pair(const gpu::Device& device, PictureSize size, RayLayers layers) {
  return {EyeTarget(device, size.width_px, size.height_px, layers),
          EyeTarget(device, size.width_px, size.height_px, layers)};
}

EyePair make_eye_pair(const gpu::Device& device, const Session& session, const Headset& headset) {
  const PipelineStage& warp = session.pipeline.at("warp");
  if (!takes_layers(warp)) return make_eye_pair(device, headset.eye);
  require_layers(session);
  const std::optional<MabPlan> mab = plan_mab(session, headset);
  return make_eye_pair(device, headset.eye, {layer_count_of(warp), mab ? mab->capacity() : 0});
}

EyeRenderer::EyeRenderer(const gpu::Device& device, const Session& session, const Headset& headset,
                         const SceneOnDevice& scene, const VolumePlacement& placement,
                         const std::filesystem::path& data_folder, Counting counting, Watchdog* watchdog,
                         SecondEye second_eye, Layers layers, RayHeat heat, History history)
    : device_(device),
      session_(session),
      headset_(headset),
      scene_(scene),
      placement_(placement),
      counting_(counting),
      makes_layers_(layers == Layers::as_session && takes_layers(session.pipeline.at("warp"))),
      pipeline_(device,
                session_kernels(session, scene, session.pipeline.at("rays"), placement, data_folder,
                                counting == Counting::on, !is_single_pass(session), makes_layers_, heat)),
      mab_(make_mab(device, session, headset)),
      own_rays_(mab_ ? RayBuffers()
                     : RayBuffers(device, headset.eye.width_px, headset.eye.height_px, guard_bytes(session))),
      full_rate_(session.pipeline.at("rays").stage.id() == "rays/full_rate"),
      commands_(device, "eyes"),
      replay_(device),
      watchdog_(watchdog) {
  BRACE_CHECK(samples_levels(session, scene) == wants_levels(session.pipeline.at("cast")));
  if (samples_levels(session, scene)) require_levels(session);
  if (is_occlusion(scene.skip_stage)) {
    if (history == History::as_session) require_occlusion(session);
    first_hits_ = std::make_unique<FirstHitMaps>(*scene.skip_kernels, occlusion_settings(scene.skip_stage),
                                                 headset.eye.width_px, headset.eye.height_px);
    keeps_first_hits_ = history == History::as_session;
  }
  if (watchdog != nullptr) {
    watchdog->arm_guard(rays().colours);
    watchdog->arm_guard(rays().depths_m);
  }
  if (second_eye == SecondEye::as_session && is_single_pass(session)) {
    single_pass_ = make_single_pass(
        {device, session, headset, scene, placement, data_folder, native_cast_}, [&](bool with_snippet) {
          const bool own_rays = with_snippet || !is_by_novel_view(session) || !session.full_rate;
          const PipelineStage& rays = own_rays ? session.pipeline.at("rays") : *session.full_rate;
          return session_kernels(session, scene, rays, placement, data_folder, counting == Counting::on,
                                 with_snippet, false);
        });
  }
  activate_native_stages();
}

void EyeRenderer::transfer_changed() {
  native_rays_.reset();
  native_cast_.reset();
  native_stereo_.reset();
  activate_native_stages();
}

void EyeRenderer::forget_first_hits() {
  if (first_hits_) first_hits_->forget();
}

void EyeRenderer::activate_native_stages() {
  const auto make = [&](const char* family, std::optional<ActiveStage>& stage) {
    if (!is_native(session_, family)) return;
    ActivationInput input = scene_activation(device_, session_, headset_, scene_, placement_);
    if (mab_) input.ray_count_max = static_cast<std::uint32_t>(rays().across * rays().down);
    if (single_pass_)
      input.ray_count_max =
          std::max(input.ray_count_max, static_cast<std::uint32_t>(single_pass_->rays_max()));
    stage.emplace(session_.pipeline.at(family), input);
  };
  make("rays", native_rays_);
  make("cast", native_cast_);
  make("stereo", native_stereo_);
}

void EyeRenderer::keep_first_hits(gpu::CommandList& commands, sim::Eye eye, const EyeTarget& target) {
  if (keeps_first_hits_) first_hits_->record(commands, static_cast<std::size_t>(eye), target);
}

void EyeRenderer::set_eye(sim::Eye eye, const EyeView& view, const EyeTarget& target) {
  if (first_hits_) {
    first_hits_->aim(static_cast<std::size_t>(eye), view, scene_.volume.info(), placement_,
                     scene_.transfer_version);
  }
  CastPipeline::set_eye(device_, target, view, placement_, scene_.volume, scene_.transfer,
                        mab_ ? std::optional(mab_->grid(eye)) : std::nullopt);
}

/// Valid until the next call.
CastPipeline::Resources EyeRenderer::resources_of(sim::Eye eye, const EyeTarget& target,
                                                  const RayBuffers& rays) {
  const auto skip = scene_.skip_bindings();
  bindings_.assign(skip.begin(), skip.end());
  if (first_hits_) {
    const auto first_hits = first_hits_->bindings(static_cast<std::size_t>(eye));
    bindings_.insert(bindings_.end(), first_hits.begin(), first_hits.end());
  }
  if (samples_levels(session_, scene_)) {
    const auto levels = scene_.levels->bindings();
    bindings_.insert(bindings_.end(), levels.begin(), levels.end());
  }
  if (makes_layers_) bindings_.push_back(layers_binding(target.layers));
  if (makes_layers_ && mab_) bindings_.push_back(layer_rays_binding(target));
  if (scan_line_rays_) {
    for (const gpu::Binding& binding : scan_line_rays_->bindings(eye))
      bindings_.push_back(binding);
  }
  std::optional<RayGrid> grid;
  if (mab_) {
    bindings_.insert(bindings_.end(), mab_->bindings(eye).begin(), mab_->bindings(eye).end());
    grid = mab_->grid(eye);
  }
  const bool cast_twice = makes_layers_ && layers_of_equal_shares(session_.pipeline.at("warp"));
  return {scene_.volume, scene_.transfer, rays, target, bindings_, scene_.skip_map(), grid, cast_twice};
}

EyeCastOutcome EyeRenderer::cast_eye_by_steps(sim::Eye eye, const Pose& world_from_head,
                                              const EyeTarget& target) {
  const EyeView view = eye_view(headset_, eye, world_from_head);
  set_eye(eye, view, target);
  const CastPipeline::Resources resources = resources_of(eye, target, rays());
  const std::string rays_id = session_.pipeline.at("rays").stage.id();
  const std::string cast_id = session_.pipeline.at("cast").stage.id();
  EyeCastOutcome outcome = cast_eye({.device = device_,
                                     .pipeline = pipeline_,
                                     .resources = resources,
                                     .view = view,
                                     .eye = static_cast<std::uint32_t>(eye),
                                     .frame = frame_,
                                     .rays = native_rays_ ? &**native_rays_ : nullptr,
                                     .full_rate = full_rate_ && !scan_line_rays_,
                                     .cast = native_cast_ ? &**native_cast_ : nullptr,
                                     .watchdog = watchdog_,
                                     .rays_id = &rays_id,
                                     .cast_id = &cast_id,
                                     .segments = segments()},
                                    commands_, host_rays_);
  if (keeps_first_hits_) {
    commands_.reset();
    keep_first_hits(commands_, eye, target);
    outcome.time_ns += gpu::total_ns(gpu::submit_and_wait(commands_));
  }
  return outcome;
}

std::int64_t EyeRenderer::compose_right_eye(const Pose& world_from_head, const EyePair& into) {
  const EyeTarget& left = into[0];
  const EyeTarget& right = into[1];
  const EyeView right_view = eye_view(headset_, sim::Eye::right, world_from_head);
  CastPipeline::set_eye(device_, right, right_view, placement_, scene_.volume, scene_.transfer);
  commands_.reset();
  commands_.begin_timing("stereo");
  brace_stereo_frame frame{};
  frame.struct_size = sizeof frame;
  frame.frame = frame_;
  frame.commands = commands_.hand_out();
  frame.left = to_abi(eye_view(headset_, sim::Eye::left, world_from_head));
  frame.right = to_abi(right_view);
  frame.left_params = buffer_range(left.params);
  frame.right_params = buffer_range(right.params);
  frame.left_image = buffer_range(left.image);
  frame.left_depth_m = buffer_range(left.depth);
  frame.right_image = buffer_range(right.image);
  frame.right_depth_m = buffer_range(right.depth);
  (*native_stereo_)->stereo(frame);
  commands_.barrier();
  commands_.end_timing();
  return gpu::total_ns(gpu::submit_and_wait(commands_));
}

JobOutcome EyeRenderer::render_by_steps(const Pose& world_from_head, const EyePair& into) {
  JobOutcome outcome;
  for (const sim::Eye eye : sim::all_eyes) {
    if (native_stereo_ && eye == sim::Eye::right) {
      outcome.device_time += SimDuration(compose_right_eye(world_from_head, into));
      continue;
    }
    const EyeCastOutcome done = cast_eye_by_steps(eye, world_from_head, into[static_cast<std::size_t>(eye)]);
    outcome.device_time += SimDuration(done.time_ns);
    outcome.work += done.counted;
  }
  ++frame_;
  if (counting_ == Counting::on) outcome.work += pipeline_.counted(device_);
  return outcome;
}

EyeCast EyeRenderer::eye_cast(sim::Eye eye, const EyeView& view, const CastPipeline::Resources& resources) {
  return {.device = device_,
          .pipeline = pipeline_,
          .resources = resources,
          .view = view,
          .eye = static_cast<std::uint32_t>(eye),
          .frame = frame_,
          .full_rate = full_rate_ && !scan_line_rays_,
          .cast = native_cast_ ? &**native_cast_ : nullptr,
          .segments = segments()};
}

SimDuration EyeRenderer::open(const EyeCast& eye, const CastArea& rays) {
  if (has_host_braces(eye)) return open_on_host(eye.resources, rays);
  return submit_step("opening", [&] { pipeline_.record_opening(commands_, eye.resources, rays); });
}

SimDuration EyeRenderer::close(const EyeCast& eye, const CastArea& image) {
  if (has_host_braces(eye)) return close_on_host(eye.resources, image);
  return submit_step("closing", [&] { pipeline_.record_closing(commands_, eye.resources, image); });
}

JobOutcome EyeRenderer::render_by_line(const ScanPoses& world_from_head, const EyePair& into) {
  if (!scan_line_rays_) scan_line_rays_.emplace(device_, headset_);
  for (const sim::Eye eye : sim::all_eyes)
    scan_line_rays_->set_last(eye, eye_view(headset_, eye, world_from_head.last_line), scene_.volume.info(),
                              placement_);
  const JobOutcome outcome = render(world_from_head.first_line, into);
  forget_first_hits();  // which are those of many views
  return outcome;
}

JobOutcome EyeRenderer::render(const Pose& world_from_head, const EyePair& into, double quality) {
  if (single_pass_) {
    if (const std::optional<JobOutcome> outcome =
            single_pass_->render(world_from_head, into, quality, nullptr)) {
      step_times_ = {.cast = outcome->device_time};
      return *outcome;
    }
  }
  if (mab_) mab_->set_quality(quality);
  if (counting_ == Counting::on) pipeline_.reset_counters(device_);
  if (native_rays_ || native_cast_ || native_stereo_ || watchdog_ != nullptr) {
    const JobOutcome outcome = render_by_steps(world_from_head, into);
    step_times_ = {.cast = outcome.device_time};
    return outcome;
  }
  commands_.reset();
  for (const sim::Eye eye : sim::all_eyes) {
    const EyeTarget& target = into[static_cast<std::size_t>(eye)];
    set_eye(eye, eye_view(headset_, eye, world_from_head), target);
    pipeline_.record(commands_, resources_of(eye, target, rays()));
    keep_first_hits(commands_, eye, target);
  }
  JobOutcome outcome;
  const std::vector<gpu::Timing>& timings = gpu::submit_and_wait(commands_);
  outcome.device_time = SimDuration(gpu::total_ns(timings));
  step_times_ = {SimDuration(gpu::device_ns(timings, "opening")),
                 SimDuration(gpu::device_ns(timings, "cast")),
                 SimDuration(gpu::device_ns(timings, "closing"))};
  if (counting_ == Counting::on) outcome.work = pipeline_.counted(device_);
  return outcome;
}

}  // namespace brace
