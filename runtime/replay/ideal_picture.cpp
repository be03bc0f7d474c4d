#include "runtime/replay/ideal_picture.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.hpp"
#include "runtime/replay/cast_integrator.hpp"
#include "runtime/replay/cast_settings.hpp"
#include "runtime/session/picture_settings.hpp"

namespace brace {

namespace {

constexpr std::uint64_t kBatchBytesMax = 256u << 20;
constexpr std::size_t kBatchMax = 8;

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

/// Rays, eye pictures and what is kept beside them, of both eyes.
std::uint64_t bytes_of_batched_head(const Headset& headset) {
  constexpr std::uint64_t ray_bytes = 52, pixel_bytes = 12;
  return 2 * static_cast<std::uint64_t>(headset.eye.width_px) *
         static_cast<std::uint64_t>(headset.eye.height_px) * (ray_bytes + pixel_bytes);
}

std::size_t batch_size_of(const EyeRenderer& renderer, const Session& session, const Headset& headset) {
  if (session.output.ideal_by_line || !renderer.casts_frames_on_host()) return 1;
  return std::clamp<std::size_t>(kBatchBytesMax / bytes_of_batched_head(headset), 1, kBatchMax);
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
      batch_size_(batch_size_of(renderer_, session_, headset)),
      identity_(identity_of(session_, headset, scene_, placement)) {}

void IdealPicture::show_batch(std::span<const TruePose> heads, std::vector<PanelPair>& pictures) {
  std::vector<EyeRenderer::Frame> frames;
  for (std::size_t i = 0; i < heads.size(); ++i) {
    if (i == eyes_.size()) eyes_.push_back(make_eye_pair(device_, headset_.eye));
    frames.push_back({heads[i].world_from_head, eyes_[i]});
  }
  if (session_.output.ideal_by_line) {
    const Pose& middle = heads.front().world_from_head;
    renderer_.render_by_line(heads.front().scan.value_or(ScanPoses{middle, middle}), eyes_.front());
  } else {
    renderer_.render_each(frames);
  }
  for (const EyeRenderer::Frame& frame : frames) {
    display_.show({frame.into, frame.world_from_head, frame.world_from_head});
    pictures.push_back(display_.read());
  }
}

std::vector<PanelPair> IdealPicture::show(std::span<const TruePose> heads) {
  std::vector<PanelPair> pictures;
  pictures.reserve(heads.size());
  for (std::size_t first = 0; first < heads.size(); first += batch_size_)
    show_batch(heads.subspan(first, std::min(batch_size_, heads.size() - first)), pictures);
  return pictures;
}

}  // namespace brace
