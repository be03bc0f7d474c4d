#include "runtime/replay/eye_renderer.hpp"

#include "base/error.hpp"
#include "runtime/host/stage_glsl.hpp"

namespace brace {

namespace {

CastKernels session_kernels(const Session& session, const SceneOnDevice& scene,
                            const std::filesystem::path& data_folder, bool counters) {
  const std::array<const PipelineStage*, 4> stages = {
      &session.pipeline.at("rays"), &session.pipeline.at("cast"), &session.pipeline.at("skip"),
      &session.pipeline.at("stereo")};
  StageGlsl glsl = stage_glsl(stages);
  CastParts parts;
  parts.glsl_folder = data_folder / "glsl";
  parts.kernels_folder = data_folder / "kernels";
  parts.stages = std::move(glsl.resolve);
  parts.constants = std::move(glsl.constants);
  parts.phong = session.scene.shading == "phong";
  parts.counters = counters;
  return compose_cast_kernels(parts, scene.volume);
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
      headset_(headset),
      scene_(scene),
      placement_(placement),
      counting_(counting),
      pipeline_(device, session_kernels(session, scene, data_folder, counting == Counting::on)),
      rays_(device, headset.eye.width_px, headset.eye.height_px),
      commands_(device, "eyes") {}

JobOutcome EyeRenderer::render(const Pose& world_from_head, const EyePair& into) {
  if (counting_ == Counting::on) pipeline_.reset_counters(device_);
  commands_.reset();
  for (const sim::Eye eye : sim::all_eyes) {
    const EyeTarget& target = into[static_cast<std::size_t>(eye)];
    CastPipeline::set_eye(device_, target, eye_view(headset_, eye, world_from_head), placement_,
                          scene_.volume, scene_.transfer);
    pipeline_.record(commands_, {scene_.volume, scene_.transfer, rays_, target});
  }
  JobOutcome outcome;
  outcome.device_time = SimDuration(total_ns(gpu::submit_and_wait(commands_)));
  if (counting_ == Counting::on) outcome.work = pipeline_.counted(device_);
  return outcome;
}

}  // namespace brace
