#include "runtime/replay/series_work.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "base/error.hpp"
#include "runtime/frame/counted_work.hpp"
#include "runtime/raycast/volume_levels.hpp"
#include "runtime/replay/cast_integrator.hpp"
#include "runtime/replay/recorded_work.hpp"
#include "runtime/replay/series_facts.hpp"
#include "runtime/report/progress.hpp"

namespace brace {

namespace {

/// Shares of the rays that are probed where load control can change them.
constexpr std::array kQualities = {0.7, 0.5, 0.35, 0.25, 0.15, 0.08};

bool makes_pictures(const Session& session) {
  using Kind = Session::Output::Selection::Kind;
  return session.output.images.kind != Kind::none || session.output.error.kind != Kind::none;
}

/// Costs that are made from counted work.
bool prices_work(const Session& session) {
  return session.clock.cost.rfind("model:", 0) == 0 || session.clock.cost.rfind("stage:", 0) == 0;
}

/// Up to `probes` vsyncs of the run, and both sides of each change of the transfer function.
std::set<SimTime> probe_times(const TransferSchedule& transfer, const Headset& headset, std::int64_t vsyncs,
                              int probes) {
  const sim::VsyncClock clock(SimTime(), headset.profile.refresh);
  const std::int64_t count = std::min<std::int64_t>(probes, vsyncs);
  std::set<SimTime> times;
  for (std::int64_t i = 0; i < count; ++i)
    times.insert(clock.time_of(count == 1 ? 0 : i * (vsyncs - 1) / (count - 1)));
  for (const SimTime change : transfer.changes()) {
    if (change > clock.time_of(vsyncs - 1)) break;
    times.insert(change - SimDuration(1));
    times.insert(change);
  }
  return times;
}

/// Whether the number of rays follows what the control stage asks for.
bool quality_counts(const Session& session) {
  return session.pipeline.at("rays").stage.id() == "rays/mab" &&
         session.pipeline.at("control").stage.id() != "control/fixed";
}

/// A cast's counts, and where the session casts in cells how they are spread over them.
WorkProbe probe_cast(const Session& session, EyeRenderer& renderer, const Pose& pose, const EyePair& eyes) {
  const PipelineStage& schedule = session.pipeline.at("schedule");
  if (schedule.stage.id() != "schedule/chunked")
    return {.time = {}, .cast = renderer.render(pose, eyes).work};
  const JobOutcome outcome = renderer.render_cells(
      pose, eyes, 1.0,
      {static_cast<int>(schedule.value("columns")), static_cast<int>(schedule.value("rows"))});
  WorkProbe probe{.time = {}, .cast = outcome.work};
  // An empty cell still has its rays to look at.
  const double all = static_cast<double>(outcome.work.samples + outcome.cells.size());
  for (const CellOutcome& cell : outcome.cells)
    probe.cell_shares.push_back(static_cast<double>(cell.work.samples + 1) / all);
  return probe;
}

/// Counts of work along the head's motion, from eye frames rendered at the true poses.
CountedWork probe_work(const SeriesWorkInputs& in, EyeRenderer& renderer, SceneOnDevice& scene,
                       PanelDisplay& display) {
  const EyePair eyes = make_eye_pair(*in.device, in.session, in.headset);
  const std::set<SimTime> times =
      probe_times(scene.versions.schedule(), in.headset, in.vsyncs, in.options.probes);
  HeadMotion head = in.head;
  std::vector<double> qualities;
  if (quality_counts(in.session)) qualities.assign(kQualities.begin(), kQualities.end());
  std::vector<WorkProbe> probes;
  ProgressMeter meter("probing work", static_cast<std::uint64_t>(times.size()), "frames");
  WorkCounts update;
  for (const SimTime time : times) {
    const std::int64_t version = scene.versions.schedule().version_at(time);
    if (version != scene.transfer_version) {
      update = scene.show_transfer(*in.device, version).work;
      renderer.transfer_changed();
    }
    const Pose pose = head.true_pose(time);
    if (in.gaze != nullptr) renderer.look_at(in.gaze->known_at(time));
    WorkProbe probe = probe_cast(in.session, renderer, pose, eyes);
    probe.time = time;
    probe.warp = display.counts_work() ? display.show({eyes, pose, pose}).work : display.work();
    probe.update = update;
    for (const double quality : qualities)
      probe.cast_below.push_back(renderer.render(pose, eyes, quality).work);
    probes.push_back(std::move(probe));
    meter.update(probes.size());
    throw_if_interrupted(in.options);
  }
  meter.finish();
  return CountedWork(std::move(probes), SimDuration(0), std::move(qualities));
}

std::string probe_fact(std::int64_t vsyncs, int probes) {
  return fmt::format("interpolated between {} eye frames rendered along the trace",
                     std::min<std::int64_t>(probes, vsyncs));
}

std::unique_ptr<FrameWork> count_with_probes(const SeriesWorkInputs& in, SeriesWork& work) {
  SceneOnDevice& scene = *work.scene;
  EyeRenderer renderer(*in.device, in.session, in.headset, scene, in.placement, in.options.data_folder,
                       EyeRenderer::Counting::on, work.watchdog.get(), EyeRenderer::SecondEye::as_session,
                       EyeRenderer::Layers::as_session);
  PanelDisplay display(*in.device, in.headset, in.session.pipeline.at("warp"), in.options.no_warp,
                       scene_activation(*in.device, in.session, in.headset, scene, in.placement),
                       in.options.data_folder);
  auto counted = std::make_unique<CountedWork>(probe_work(in, renderer, scene, display));
  if (const std::string note = renderer.stereo_note(); !note.empty())
    work.facts.push_back({in.session.pipeline.at("stereo").stage.id() + ", frames", note});
  return counted;
}

/// What single-pass stereo takes, said before any of it is allocated.
void announce_stereo(const SeriesWorkInputs& in, SeriesWork& work) {
  if (is_by_novel_view(in.session)) {
    const NovelViewMemory memory = novel_view_memory(in.session, in.headset);
    if (in.options.messages) fmt::print(stderr, "stereo/novel_view: {}\n", memory.summary);
    work.facts.push_back({"stereo/novel_view", memory.summary});
    work.stereo_layer_mib = static_cast<double>(memory.bytes) / (1024.0 * 1024.0);
  }
  if (!is_by_layers(in.session)) return;
  const StereoPlan plan =
      plan_single_pass(*in.device, in.session, in.headset, work.scene->volume.info(), in.placement);
  if (in.options.messages) fmt::print(stderr, "stereo/layers: {}\n", plan.summary);
  work.facts.push_back({"stereo/layers", plan.summary});
  work.stereo_layer_mib = static_cast<double>(plan.bytes) / (1024.0 * 1024.0);
  if (plan.layers_left_out) work.left_out.push_back({"stereo", plan.summary});
}

/// What rays/mab makes of the headset, and whether load control has anything to control.
void announce_rays(const SeriesWorkInputs& in, SeriesWork& work) {
  const std::string control = in.session.pipeline.at("control").stage.id();
  const std::string rays = in.session.pipeline.at("rays").stage.id();
  if (const std::optional<MabPlan> plan = plan_mab(in.session, in.headset)) {
    work.facts.push_back({rays, plan->summary()});
  } else if (control != "control/fixed") {
    work.facts.push_back({control, "no effect: " + rays + " casts the same rays at every quality"});
  }
}

void load(const SeriesWorkInputs& in, SeriesWork& work) {
  work.scene = load_scene(*in.device, in.session, in.options, in.headset, in.placement);
  if (work.scene->skip) work.facts.push_back({"skip memory", work.scene->skip_memory});
  work.facts.push_back({"volume path", work.scene->volume.path_reason()});
  if (const std::string& figures = work.scene->volume.path_figures(); !figures.empty())
    work.host_facts.push_back({"volume path", figures});
  if (work.scene->levels) work.facts.push_back({"volume levels", work.scene->levels->summary()});
  for (const std::string& note : work.scene->volume.info().notes)
    work.facts.push_back({"volume", note});
  announce_stereo(in, work);
}

}  // namespace

bool needs_device(const Session& session) {
  return makes_pictures(session) || prices_work(session) || session.clock.cost == "measured";
}

SeriesWork make_work(const SeriesWorkInputs& in) {
  const Session& session = in.session;
  SeriesWork work;
  require_agreement(session);
  announce_rays(in, work);
  if (in.device != nullptr && needs_device(session)) load(in, work);
  if (work.scene && session.run.watchdog != WatchdogLevel::off) {
    work.watchdog =
        std::make_unique<Watchdog>(*in.device, session.run.watchdog, in.options.data_folder / "kernels");
  }
  if (makes_pictures(session) || session.clock.cost == "measured") {
    const std::string folder = in.label.empty() ? "images" : "images-" + file_part(in.label);
    auto rendered = std::make_unique<PixelWork>(
        PixelWork::Inputs{*in.device, session, in.headset, *work.scene, in.placement, in.options, in.vsyncs,
                          in.run, folder, in.ideals, work.watchdog.get()});
    work.pixels = rendered.get();
    work.frame_work = std::move(rendered);
  } else if (work.scene) {
    work.frame_work = count_with_probes(in, work);
    work.facts.push_back({"counted work", probe_fact(in.vsyncs, in.options.probes)});
  } else if (session.clock.cost.rfind("recorded:", 0) == 0) {
    work.frame_work = std::make_unique<RecordedWork>(session.clock.cost.substr(9));
    work.facts.push_back({"counted work", "that of the recorded run"});
  } else {
    work.frame_work = std::make_unique<CountedWork>(std::vector<WorkProbe>{{.time = SimTime()}});
    work.facts.push_back({"counted work", "none: nothing was rendered"});
  }
  return work;
}

}  // namespace brace
