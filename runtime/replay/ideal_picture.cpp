#include "runtime/replay/ideal_picture.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "runtime/replay/cast_integrator.hpp"
#include "runtime/replay/cast_settings.hpp"
#include "runtime/session/picture_settings.hpp"

namespace brace {

namespace {

[[noreturn]] void refuse_native(const Session& session, const std::string& why) {
  throw input_error("{}: output.ideal_cast = 'native': {}; accepted: 'session'", session.file.string(), why);
}

/// cast/native with what the session's cast stage is told.
PipelineStage native_cast_of(const Session& session) {
  const PipelineStage& cast = session.pipeline.at("cast");
  if (cast.stage.id() == "cast/native") return cast;
  if (!session.native_cast) refuse_native(session, "there is no cast/native here");
  if (cast.stage.id() != "cast/dvr")
    refuse_native(session, fmt::format("it cannot stand for {}", cast.stage.id()));
  if (session.output.converged_ideal)
    refuse_native(session, "output.ideal = 'converged' is made by cast/dvr");
  if (session.pipeline.at("skip").stage.id() == "skip/occlusion")
    refuse_native(session, "cast/native does not know skip/occlusion");
  PipelineStage native = *session.native_cast;
  try {
    for (const auto& [name, value] : settings_for(cast, native.stage))
      native.set(name, value);
  } catch (const Error& error) {
    refuse_native(session, error.what());
  }
  return native;
}

/// The session of ideal pictures: lit as asked for, a ray per pixel, of the finest level, and where the
/// session asks for them converged ones.
Session ideal_session(Session session, const ReplayOptions& options) {
  const PipelineStage& rays = options.full_rate;
  session.pipeline.at("rays") =
      session.output.ideal_by_line ? ScanLineRays::opening(rays, options.data_folder) : rays;
  session.scene.shading = session.plan.shading;
  if (wants_levels(session.pipeline.at("cast"))) session.pipeline.at("cast").set_choice("lod", "off");
  if (session.output.native_ideal) session.pipeline.at("cast") = native_cast_of(session);
  if (!session.output.converged_ideal) return session;
  if (const auto converged = converged_session(session)) return *converged;
  throw input_error(
      "{}: output.ideal = 'converged' is made by cast/dvr; accepted with pipeline.cast = '{}': session",
      session.file.string(), session.pipeline.at("cast").stage.name);
}

std::unique_ptr<SceneOnDevice> scene_of_ideal(const gpu::Device& device, const Session& session,
                                              const Headset& headset, const SceneOnDevice& scene,
                                              const VolumePlacement& placement, ReplayOptions options) {
  if (!session.output.converged_ideal) return nullptr;
  options.messages = false;
  return load_scene(device, session, options, headset, placement, &scene);
}

std::string stage_text(const PipelineStage& stage) {
  return fmt::format("{} {} [{}]\n", stage.stage.id(), stage.stage.version, fmt::join(stage.values, ", "));
}

std::string identity_of(const Session& session, const Headset& headset, const SceneOnDevice& scene,
                        const VolumePlacement& placement) {
  const Pose& pose = placement.world_from_volume;
  const std::string lens =
      fmt::format("lens computed {}, channels {}", headset.distort_always, headset.fetch_channels_always);
  const std::string place = fmt::format(
      "volume at [{}, {}, {}], [{}, {}, {}, {}], {} m", pose.position.x, pose.position.y, pose.position.z,
      pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w, placement.size_m);
  return picture_settings(session) + stage_text(session.pipeline.at("cast")) + stage_text(scene.skip_stage) +
         fmt::format("{}\n{}\n{}\n", session.scene.shading, lens, place);
}

}  // namespace

IdealPicture::IdealPicture(const gpu::Device& device, const Session& session, const Headset& headset,
                           SceneOnDevice& scene, const VolumePlacement& placement,
                           const ReplayOptions& options)
    : device_(device),
      headset_(headset),
      session_(ideal_session(session, options)),
      own_scene_(scene_of_ideal(device, session_, headset, scene, placement, options)),
      scene_(own_scene_ ? *own_scene_ : scene),
      renderer_(device, session_, headset, scene_, placement, options.data_folder, EyeRenderer::Counting::off,
                nullptr, EyeRenderer::SecondEye::ray_cast),
      display_(device, headset, options.no_warp, options.data_folder),
      eyes_(make_eye_pair(device, headset.eye)),
      identity_(identity_of(session_, headset, scene_, placement)) {}

PanelPair IdealPicture::show(const TruePose& head) {
  if (session_.output.ideal_by_line) {
    renderer_.render_by_line(head.scan.value_or(ScanPoses{head.world_from_head, head.world_from_head}),
                             eyes_);
  } else {
    renderer_.render(head.world_from_head, eyes_);
  }
  display_.show({eyes_, head.world_from_head, head.world_from_head});
  return display_.read();
}

}  // namespace brace
