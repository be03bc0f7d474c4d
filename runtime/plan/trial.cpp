#include "runtime/plan/trial.hpp"

#include <algorithm>

#include <unistd.h>

#include "runtime/metrics/image_error.hpp"
#include "runtime/metrics/pacing.hpp"
#include "runtime/replay/cast_integrator.hpp"
#include "runtime/replay/gaze_source.hpp"
#include "runtime/replay/panel_display.hpp"
#include "runtime/replay/series.hpp"
#include "runtime/replay/series_work.hpp"
#include "runtime/skip/choose_skip.hpp"
#include "runtime/stereo/stereo_geometry.hpp"
#include "runtime/timeline/gpu_time.hpp"

namespace brace {

namespace {

/// Without pictures and watchdog, and not longer than a trial.
Session short_session(Session session) {
  session.output.images = {};
  session.output.error = {};
  session.run.watchdog = WatchdogLevel::off;
  session.run.frames = std::min(session.run.frames.value_or(PlanTrials::frames), PlanTrials::frames);
  return session;
}

/// A run directory that is never committed: a trial's replay writes nothing into it.
std::filesystem::path unused_folder() {
  return std::filesystem::temp_directory_path() / ("brace-trial-" + std::to_string(::getpid()));
}

}  // namespace

struct PlanTrials::Pictures {
  std::vector<PanelPair> panels;
  std::array<std::vector<std::uint8_t>, 2> visible;
};

PlanTrials::PlanTrials(ReplayOptions options) : options_(std::move(options)) {
  options_.probes = probes;
  options_.messages = false;
}

PlanTrials::~PlanTrials() = default;

const gpu::Device* PlanTrials::device_for(const Session& session) {
  if (!device_ && needs_device(session)) device_.emplace(gpu::DeviceOptions{.select = options_.gpu});
  return device_ ? &*device_ : nullptr;
}

PlanTrial PlanTrials::replay_briefly(const Session& session) {
  const auto known = replayed_.find(session.resolved_toml);
  if (known != replayed_.end()) return known->second;
  return replayed_[session.resolved_toml] = replay_now(short_session(session));
}

PlanTrial PlanTrials::replay_now(const Session& session) {
  const Headset headset = make_headset(session, options_.data_folder);
  const HeadTrace trace = load_head_trace(session.trace, options_.data_folder);
  RunDirectory nothing(unused_folder());
  IdealCache no_ideals(0);
  const Series series =
      replay_series({"", session}, options_, headset, trace, device_for(session), nothing, no_ideals);
  if (!series.failure.empty()) throw device_error("{}", series.failure);
  const PacingFigures pacing = pacing_figures(series.records.frames());
  return {gpu_time(series.jobs).frame_ms(), pacing.angular_error_deg.p95, pacing.position_error_mm.p95,
          series.deterministic};
}

const PlanTrials::Pictures& PlanTrials::pictures_of(const Session& given, bool converged) {
  std::unique_ptr<Pictures>& made = made_[(converged ? "converged\n" : "") + given.resolved_toml];
  if (made) return *made;
  const Session session = converged ? converged_session(given).value() : given;
  const gpu::Device& device = *device_for(session);
  const Headset headset = make_headset(session, options_.data_folder);
  const HeadTrace trace = load_head_trace(session.trace, options_.data_folder);
  HeadMotion head(trace.trace, sim::Interpolation::hermite, headset.profile.tracker, session.run.seed,
                  session.trace.loop, trace.trace.begin_time() + from_s(session.trace.start_s));
  std::optional<GazeMotion> gaze = make_gaze(session, trace.trace, head);
  const VolumePlacement placement = place_volume(session.scene, head.true_pose(SimTime()));
  const auto scene = load_scene(device, session, options_, headset, placement);
  EyeRenderer renderer(device, session, headset, *scene, placement, options_.data_folder,
                       EyeRenderer::Counting::off);
  PanelDisplay display(device, headset, options_.no_warp, options_.data_folder);
  const EyePair eyes = make_eye_pair(device, headset.eye);
  made = std::make_unique<Pictures>();
  for (const sim::Eye eye : sim::all_eyes)
    made->visible[static_cast<std::size_t>(eye)] = visible_pixels(headset, eye);
  const sim::VsyncClock clock(SimTime(), headset.profile.refresh);
  const std::int64_t last = std::min(session.run.frames.value_or(frames), frames) - 1;
  for (int i = 0; i < pictures; ++i) {
    const SimTime time = std::min(clock.time_of(last * i / (pictures - 1)), head.end_time());
    const Pose pose = head.true_pose(time);
    if (gaze) renderer.look_at(gaze->known_at(time));
    renderer.render(pose, eyes);
    display.show({eyes, pose, pose});
    made->panels.push_back(display.read());
  }
  return *made;
}

double PlanTrials::largest_dssim(const Pictures& a, const Pictures& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.panels.size(); ++i)
    for (std::size_t eye = 0; eye < 2; ++eye)
      largest = std::max(largest, dssim_from_ssim(ssim(a.panels[i][eye], b.panels[i][eye], a.visible[eye])));
  return largest;
}

std::optional<VolumeFacts> PlanTrials::look_at_volume(const Session& session) {
  const gpu::Device* device = device_for(session);
  if (device == nullptr) return std::nullopt;
  const Headset headset = make_headset(session, options_.data_folder);
  const HeadTrace trace = load_head_trace(session.trace, options_.data_folder);
  const VolumePlacement placement = place_volume(session.scene, trace.trace.poses().front().world_from_head);
  const auto scene = load_scene(*device, session, options_, headset, placement);
  const std::vector<TransferTable> tables = scene->versions.typical_tables();
  std::vector<double> occupancies;
  for (const TransferTable& table : tables)
    occupancies.push_back(occupied_blocks(*scene->skip_kernels, {scene->volume, scene->statistics}, table));
  VolumeFacts facts = volume_facts(tables, occupancies, scene->statistics.range, step_voxels_of(session));
  facts.bounding_radius_m = bounding_radius_m(scene->volume.info(), placement);
  return facts;
}

std::optional<double> PlanTrials::picture_change(const Session& a, const Session& b) {
  if (!needs_device(a) || !needs_device(b)) return std::nullopt;
  return largest_dssim(pictures_of(a), pictures_of(b));
}

std::optional<double> PlanTrials::picture_error(const Session& session) {
  if (!needs_device(session) || !converged_session(session)) return std::nullopt;
  return largest_dssim(pictures_of(session), pictures_of(session, true));
}

}  // namespace brace
