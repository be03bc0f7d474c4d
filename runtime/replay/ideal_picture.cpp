#include "runtime/replay/ideal_picture.hpp"

#include "base/error.hpp"
#include "runtime/replay/cast_integrator.hpp"

namespace brace {

namespace {

/// The session of ideal pictures: lit as asked for, a ray per pixel, of the finest level, and where the
/// session asks for them converged ones.
Session ideal_session(Session session, const ReplayOptions& options) {
  const PipelineStage& rays = options.full_rate;
  session.pipeline.at("rays") =
      session.output.ideal_by_line ? ScanLineRays::opening(rays, options.data_folder) : rays;
  session.scene.shading = session.plan.shading;
  if (wants_levels(session.pipeline.at("cast"))) session.pipeline.at("cast").set_choice("lod", "off");
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

}  // namespace

IdealPicture::IdealPicture(const gpu::Device& device, const Session& session, const Headset& headset,
                           SceneOnDevice& scene, const VolumePlacement& placement,
                           const ReplayOptions& options)
    : session_(ideal_session(session, options)),
      own_scene_(scene_of_ideal(device, session_, headset, scene, placement, options)),
      scene_(own_scene_ ? *own_scene_ : scene),
      renderer_(device, session_, headset, scene_, placement, options.data_folder, EyeRenderer::Counting::off,
                nullptr, EyeRenderer::SecondEye::ray_cast),
      display_(device, headset, options.no_warp, options.data_folder),
      eyes_(make_eye_pair(device, headset.eye)) {}

PanelPair IdealPicture::show(const Pose& true_world_from_head, const std::optional<ScanPoses>& true_scan) {
  if (session_.output.ideal_by_line) {
    renderer_.render_by_line(true_scan.value_or(ScanPoses{true_world_from_head, true_world_from_head}),
                             eyes_);
  } else {
    renderer_.render(true_world_from_head, eyes_);
  }
  display_.show({eyes_, true_world_from_head, true_world_from_head});
  return display_.read();
}

}  // namespace brace
