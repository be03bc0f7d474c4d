#include "runtime/replay/single_pass.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace brace {

namespace {

void require_stages(const Session& session) {
  if (session.run.watchdog != WatchdogLevel::off) {
    throw input_error(
        "run.watchdog = '{}' does not look into stereo/layers; accepted with it: 'off', or stereo/two_pass",
        to_string(session.run.watchdog));
  }
  const StageInfo& rays = session.pipeline.at("rays").stage;
  if (rays.id() != "rays/full_rate") {
    throw input_error(
        "stereo/layers does not work with {}: its layers need a ray per pixel; accepted: rays/full_rate, or "
        "stereo/two_pass",
        rays.id());
  }
  const StageInfo& cast = session.pipeline.at("cast").stage;
  const auto& outputs = cast.outputs;
  if (std::find(outputs.begin(), outputs.end(), "segments") == outputs.end()) {
    throw input_error(
        "stereo/layers does not work with {}: that stage does not give its segments (outputs = "
        "[\"segments\"]); accepted: cast/dvr, or stereo/two_pass",
        cast.id());
  }
}

EyeViews views_of(const Headset& headset, const Pose& world_from_head) {
  return {eye_view(headset, sim::Eye::left, world_from_head),
          eye_view(headset, sim::Eye::right, world_from_head)};
}

}  // namespace

bool is_single_pass(const Session& session) {
  return session.pipeline.at("stereo").stage.id() == "stereo/layers";
}

StereoPlan plan_single_pass(const gpu::Device& device, const Session& session, const Headset& headset,
                            const VolumeInfo& volume, const VolumePlacement& placement) {
  require_stages(session);
  const EyeViews eyes = views_of(headset, Pose{});
  const gpu::DeviceLimits& limits = device.limits();
  return plan_stereo(
      stereo_settings(session.pipeline.at("stereo")), stereo_geometry(eyes.left, eyes.right),
      headset.eye.width_px, headset.eye.height_px, bounding_radius_m(volume, placement),
      {std::min(limits.storage_buffer_bytes_max, limits.allocation_bytes_max), limits.memory_bytes});
}

SinglePass::SinglePass(const Inputs& in, const StereoPlan& plan, const CastKernels& kernels)
    : device_(in.device),
      headset_(in.headset),
      scene_(in.scene),
      placement_(in.placement),
      pipeline_(in.device, kernels),
      layers_(in.device, in.session.pipeline.at("stereo"), plan, in.headset.eye.width_px,
              in.headset.eye.height_px, {in.data_folder / "glsl", in.data_folder / "kernels" / "stereo"}),
      commands_(in.device, "single-pass stereo") {}

std::optional<JobOutcome> SinglePass::render(const Pose& world_from_head, const EyePair& into) {
  const EyeViews eyes = views_of(headset_, world_from_head);
  ++frames_;
  if (!layers_.begin_frame(eyes, scene_.volume.info(), placement_)) {
    ++cast_twice_;
    return {};
  }
  const EyeTarget& left = into[0];
  const EyeTarget& right = into[1];
  CastPipeline::set_eye(device_, left, eyes.left, placement_, scene_.volume, scene_.transfer, layers_.grid());
  CastPipeline::set_eye(device_, right, eyes.right, placement_, scene_.volume, scene_.transfer);
  const auto skip = scene_.skip_bindings();
  bindings_.assign(skip.begin(), skip.end());
  if (!layers_.plan().layers_left_out) {
    bindings_.insert(bindings_.end(), layers_.bindings().begin(), layers_.bindings().end());
  }
  const CastPipeline::Resources resources{scene_.volume, scene_.transfer, layers_.rays(), left, bindings_};
  pipeline_.reset_counters(device_);
  commands_.reset();
  const auto step = [&](const char* name, const auto& record) {
    commands_.begin_timing(name);
    record();
    commands_.barrier();
    commands_.end_timing();
  };
  commands_.barrier();
  step("opening", [&] { pipeline_.record_opening(commands_, resources, layers_.ray_area()); });
  step("cast", [&] { pipeline_.record_cast(commands_, resources, layers_.ray_area()); });
  step("closing", [&] {
    pipeline_.record_closing(commands_, resources, {0, 0, left.width_px, left.height_px});
  });
  step("stereo", [&] { layers_.record_second_eye(commands_, left, right); });
  JobOutcome outcome;
  for (const gpu::Timing& timing : gpu::submit_and_wait(commands_))
    outcome.device_time += SimDuration(timing.device_ns);
  outcome.work = pipeline_.counted(device_);
  return outcome;
}

std::string SinglePass::note() const {
  if (cast_twice_ == 0) return "";
  return fmt::format(
      "{} of {} eye frames were ray cast twice: the volume was nearer than the layers allow ({}); a smaller "
      "near_m, or more layers, takes it",
      cast_twice_, frames_, layers_.plan().summary);
}

}  // namespace brace
