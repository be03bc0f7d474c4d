#include "runtime/replay/eye_renderer.hpp"

#include "base/error.hpp"
#include "runtime/host/stage_glsl.hpp"

namespace brace {

namespace {

bool is_native(const Session& session, const char* family) {
  return session.pipeline.at(family).stage.native != nullptr;
}

CastKernels session_kernels(const Session& session, const SceneOnDevice& scene,
                            const std::filesystem::path& data_folder, bool counters) {
  const std::array<const PipelineStage*, 4> stages = {&session.pipeline.at("rays"),
                                                      &session.pipeline.at("cast"), &scene.skip_stage,
                                                      &session.pipeline.at("stereo")};
  for (const char* family : {"skip", "stereo"}) {
    if (!is_native(session, family)) continue;
    const StageInfo& stage = session.pipeline.at(family).stage;
    throw input_error("{}: stage {} is a shared library's; accepted for pipeline.{}: GLSL stages",
                      stage.origin.string(), stage.id(), family);
  }
  StageGlsl glsl = stage_glsl(stages);
  CastParts parts;
  parts.glsl_folder = data_folder / "glsl";
  parts.kernels_folder = data_folder / "kernels";
  parts.stages = std::move(glsl.resolve);
  parts.constants = std::move(glsl.constants);
  parts.phong = session.scene.shading == "phong";
  parts.counters = counters;
  parts.native_rays = is_native(session, "rays");
  parts.native_cast = is_native(session, "cast");
  return compose_cast_kernels(parts, scene.volume);
}

WorkCounts sum(WorkCounts a, const WorkCounts& b) {
  a.rays += b.rays;
  a.samples += b.samples;
  a.skip_steps += b.skip_steps;
  a.shading_fetches += b.shading_fetches;
  return a;
}

std::int64_t total_ns(std::span<const gpu::Timing> timings) {
  std::int64_t total = 0;
  for (const gpu::Timing& timing : timings)
    total += timing.device_ns;
  return total;
}

}  // namespace

EyePair make_eye_pair(const gpu::Device& device, PictureSize size) {
  return {EyeTarget(device, size.width_px, size.height_px), EyeTarget(device, size.width_px, size.height_px)};
}

EyeRenderer::EyeRenderer(const gpu::Device& device, const Session& session, const Headset& headset,
                         const SceneOnDevice& scene, const VolumePlacement& placement,
                         const std::filesystem::path& data_folder, Counting counting)
    : device_(device),
      session_(session),
      headset_(headset),
      scene_(scene),
      placement_(placement),
      counting_(counting),
      pipeline_(device, session_kernels(session, scene, data_folder, counting == Counting::on)),
      rays_(device, headset.eye.width_px, headset.eye.height_px),
      commands_(device, "eyes") {
  activate_native_stages();
}

void EyeRenderer::transfer_changed() {
  if (activation_ == nullptr) return;
  native_rays_ = {};
  native_cast_ = {};
  activation_.reset();
  activate_native_stages();
}

void EyeRenderer::activate_native_stages() {
  const auto make = [&](const char* family, NativeStage& stage) {
    if (!is_native(session_, family)) return;
    if (activation_ == nullptr) {
      ActivationInput input =
          activation_input(device_, scene_.volume, placement_, scene_.table, step_voxels_of(session_),
                           headset_.eye.width_px, headset_.eye.height_px);
      if (session_.scene.shading == "phong") input.shading = BRACE_SHADING_PHONG;
      OpenOptions as_on_device;
      if (session_.scene.nan == "empty") as_on_device.non_finite = NonFinitePolicy::treat_as_empty;
      input.open_volume = [as_on_device, source = session_.scene.volume] {
        return open_volume(source, as_on_device);
      };
      activation_ = std::make_unique<StageActivation>(input);
    }
    stage = NativeStage(session_.pipeline.at(family));
    try {
      stage.activate(activation_->get());
    } catch (const Error&) {
      activation_->rethrow_read_error();
      throw;
    }
  };
  make("rays", native_rays_);
  make("cast", native_cast_);
}

JobOutcome EyeRenderer::render_with_native_stages(const Pose& world_from_head, const EyePair& into) {
  JobOutcome outcome;
  for (const sim::Eye eye : sim::all_eyes) {
    const EyeTarget& target = into[static_cast<std::size_t>(eye)];
    const EyeView view = eye_view(headset_, eye, world_from_head);
    CastPipeline::set_eye(device_, target, view, placement_, scene_.volume, scene_.transfer);
    const CastPipeline::Resources resources{scene_.volume, scene_.transfer,        rays_,
                                            target,        scene_.skip_bindings(), scene_.skip_map()};
    const EyeCast cast{.device = device_,
                       .pipeline = pipeline_,
                       .resources = resources,
                       .view = view,
                       .eye = static_cast<std::uint32_t>(eye),
                       .frame = frame_,
                       .rays = native_rays_ ? &native_rays_ : nullptr,
                       .cast = native_cast_ ? &native_cast_ : nullptr};
    const EyeCastOutcome done = cast_eye(cast, commands_, host_rays_);
    outcome.device_time += SimDuration(done.time_ns);
    outcome.work = sum(outcome.work, done.counted);
  }
  ++frame_;
  if (counting_ == Counting::on) outcome.work = sum(outcome.work, pipeline_.counted(device_));
  return outcome;
}

JobOutcome EyeRenderer::render(const Pose& world_from_head, const EyePair& into) {
  if (counting_ == Counting::on) pipeline_.reset_counters(device_);
  if (activation_ != nullptr) return render_with_native_stages(world_from_head, into);
  commands_.reset();
  for (const sim::Eye eye : sim::all_eyes) {
    const EyeTarget& target = into[static_cast<std::size_t>(eye)];
    CastPipeline::set_eye(device_, target, eye_view(headset_, eye, world_from_head), placement_,
                          scene_.volume, scene_.transfer);
    pipeline_.record(commands_, {scene_.volume, scene_.transfer, rays_, target, scene_.skip_bindings()});
  }
  JobOutcome outcome;
  outcome.device_time = SimDuration(total_ns(gpu::submit_and_wait(commands_)));
  if (counting_ == Counting::on) outcome.work = pipeline_.counted(device_);
  return outcome;
}

}  // namespace brace
