#include "runtime/replay/series.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "base/error.hpp"
#include "runtime/frame/counted_work.hpp"
#include "runtime/replay/pixel_work.hpp"
#include "runtime/replay/recorded_work.hpp"
#include "runtime/replay/stage_instance.hpp"
#include "runtime/report/progress.hpp"

namespace brace {

namespace {

constexpr int kProbes = 64;

bool makes_pictures(const Session& session) {
  using Kind = Session::Output::Selection::Kind;
  return session.output.images.kind != Kind::none || session.output.error.kind != Kind::none;
}

bool has_model_cost(const Session& session) {
  return session.clock.cost.rfind("model:", 0) == 0;
}

std::unique_ptr<CostSource> make_cost(const Session& session, const std::filesystem::path& data_folder) {
  const Session::Clock& clock = session.clock;
  const double scale = session.device.resolution_scale;
  const double pixel_scale = clock.cost_resolution == "full" ? 1.0 / (scale * scale) : 1.0;
  if (clock.cost == "measured") return make_measured_cost(clock.cost_scale);
  if (clock.cost == "scripted") {
    std::vector<CostSegment> segments;
    for (const auto& s : clock.script)
      segments.push_back({s.from_s, s.cast_ms, s.warp_ms, s.update_ms});
    return make_scripted_cost(segments, clock.cost_scale);
  }
  const std::string name = clock.cost.substr(clock.cost.find(':') + 1);
  if (!has_model_cost(session)) return make_recorded_cost(name, clock.cost_scale);
  return make_model_cost(find_cost_model(data_folder / "costs", name), pixel_scale, clock.cost_scale);
}

/// What a warp stage takes from the pose latched for it; its manifest's inputs say so.
WarpPose warp_pose_of(const PipelineStage& warp) {
  const auto& inputs = warp.stage.inputs;
  const auto has = [&](const char* name) {
    return std::find(inputs.begin(), inputs.end(), name) != inputs.end();
  };
  if (has("translation")) return WarpPose::rotation_and_translation;
  return has("rotation") ? WarpPose::rotation : WarpPose::none;
}

FrameLoopConfig loop_config(const Session& session, const Headset& headset,
                            std::optional<std::int64_t> vsyncs) {
  FrameLoopConfig config;
  config.display = display_of(headset.profile);
  config.vsyncs_max = vsyncs;
  const Session::Clock& clock = session.clock;
  config.queue = clock.queue == "single"     ? QueueKind::single
                 : clock.queue == "priority" ? QueueKind::priority
                                             : QueueKind::dual;
  config.preemption.granularity = from_s(clock.preempt_granularity_us * 1e-6);
  config.preemption.switch_cost = from_s(clock.switch_cost_us * 1e-6);
  config.pace = session.pipeline.at("schedule").value("pace") == 0.0 ? Pace::vsync : Pace::free;
  config.warp_pose = warp_pose_of(session.pipeline.at("warp"));
  if (clock.warp_lead_ms) config.warp_lead = from_s(*clock.warp_lead_ms * 1e-3);
  return config;
}

/// The number of vsyncs of a run, known before it: what the trace covers, or what was asked for.
std::int64_t vsync_count(const Session& session, const Headset& headset, const HeadMotion& head) {
  const std::int64_t asked = session.run.frames.value_or(std::numeric_limits<std::int64_t>::max());
  if (head.end_time() == SimTime::max()) return asked;
  const sim::VsyncClock clock(SimTime(), headset.profile.refresh);
  return std::min(asked, clock.last_at_or_before(head.end_time()) + 1);
}

std::vector<StageChoice> stage_choices(const Session& session) {
  std::vector<StageChoice> choices;
  for (const std::string& family : stage_families()) {
    const auto found = session.pipeline.find(family);
    if (found != session.pipeline.end()) choices.push_back({family, found->second.stage.id()});
  }
  return choices;
}

std::vector<LeftOut> left_out(const Session& session, const Headset& headset) {
  std::vector<LeftOut> left;
  for (const auto& [family, chosen] : session.pipeline) {
    if (chosen.stage.name == "none") left.push_back({family, "the session names none"});
  }
  if (session.scene.shading == "none") left.push_back({"shading", "unlit: no gradient in the kernel"});
  const sim::EyeProfile& eye = headset.profile.eyes[0];
  if (sim::lens_is_identity(eye.lens, eye.fov)) {
    left.push_back({"distortion", "the lens polynomial is 1"});
  } else if (sim::lens_channels_equal(eye.lens)) {
    left.push_back({"chromatic channels", "the channels' polynomials are equal: one fetch instead of three"});
  }
  if (headset.profile.scan_out.direction == sim::ScanDirection::global) {
    left.push_back({"scan-out correction", "the panel is lit at once"});
  }
  return left;
}

/// Up to kProbes vsyncs of the run, and both sides of each change of the transfer function.
std::set<SimTime> probe_times(const TransferSchedule& transfer, const Headset& headset, std::int64_t vsyncs) {
  const sim::VsyncClock clock(SimTime(), headset.profile.refresh);
  const std::int64_t count = std::min<std::int64_t>(kProbes, vsyncs);
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

/// Counts of work along the head's motion, from eye frames rendered at the true poses.
CountedWork probe_work(EyeRenderer& renderer, const gpu::Device& device, SceneOnDevice& scene,
                       HeadMotion head, std::int64_t vsyncs, const Headset& headset, const WorkCounts& warp,
                       const ReplayOptions& options) {
  const EyePair eyes = make_eye_pair(device, headset.eye);
  const std::set<SimTime> times = probe_times(scene.versions.schedule(), headset, vsyncs);
  std::vector<WorkProbe> probes;
  ProgressMeter meter("probing work", static_cast<std::uint64_t>(times.size()), "frames");
  WorkCounts update;
  for (const SimTime time : times) {
    const std::int64_t version = scene.versions.schedule().version_at(time);
    if (version != scene.transfer_version) {
      update = scene.show_transfer(device, version).work;
      renderer.transfer_changed();
    }
    probes.push_back({time, renderer.render(head.true_pose(time), eyes).work, warp, update});
    meter.update(probes.size());
    throw_if_interrupted(options);
  }
  meter.finish();
  return CountedWork(std::move(probes));
}

class ProgressSink final : public RecordSink {
 public:
  ProgressSink(RunRecords& records, std::int64_t vsyncs, const ReplayOptions& options)
      : records_(records),
        options_(options),
        meter_("replaying", static_cast<std::uint64_t>(vsyncs), "vsyncs") {}
  void add(const FrameRecord& record) override {
    records_.add(record);
    meter_.update(static_cast<std::uint64_t>(record.vsync_index + 1));
    throw_if_interrupted(options_);
  }
  void add(const JobRecord& record) override { records_.add(record); }
  void finish() { meter_.finish(); }

 private:
  RunRecords& records_;
  const ReplayOptions& options_;
  ProgressMeter meter_;
};

/// pipeline.skip = "auto" in the report: what it became, and why.
void apply_skip_choice(const SceneOnDevice& scene, Series& series) {
  if (scene.skip_reason.empty()) return;
  for (StageChoice& choice : series.pipeline)
    if (choice.family == "skip") choice.stage = scene.skip_stage.stage.id();
  series.facts.push_back({"skip/auto", scene.skip_reason});
  if (!scene.skip) series.left_out.push_back({"skip", scene.skip_reason});
}

std::string probe_fact(std::int64_t vsyncs) {
  return fmt::format("interpolated between {} eye frames rendered along the trace",
                     std::min<std::int64_t>(kProbes, vsyncs));
}

}  // namespace

bool needs_device(const Session& session) {
  return makes_pictures(session) || has_model_cost(session) || session.clock.cost == "measured";
}

Series replay_series(const LabelledSession& labelled, const ReplayOptions& options, const Headset& headset,
                     const HeadTrace& head_trace, const gpu::Device* device, RunDirectory& run) {
  const Session& session = labelled.session;
  Series series;
  series.label = labelled.label;
  series.pipeline = stage_choices(session);
  series.left_out = left_out(session, headset);

  const SimTime start = head_trace.trace.begin_time() + from_s(session.trace.start_s);
  HeadMotion head(
      head_trace.trace,
      session.trace.interpolation == "slerp" ? sim::Interpolation::slerp_linear : sim::Interpolation::hermite,
      headset.profile.tracker, session.run.seed, session.trace.loop, start);
  if (session.trace.loop && !session.run.frames) {
    throw input_error("{}: 'trace.loop' runs without end; say how long with 'run.frames' or --frames",
                      session.file.string());
  }
  const std::int64_t vsyncs = vsync_count(session, headset, head);
  const VolumePlacement placement = place_volume(session.scene, head.true_pose(SimTime()));

  const std::unique_ptr<CostSource> cost = make_cost(session, options.data_folder);
  series.deterministic = cost->deterministic();

  std::unique_ptr<SceneOnDevice> scene;
  std::unique_ptr<FrameWork> work;
  const PixelWork* pixels = nullptr;
  if (device != nullptr && needs_device(session)) {
    scene = load_scene(*device, session, options, headset.profile.refresh);
    apply_skip_choice(*scene, series);
    if (scene->skip) series.facts.push_back({"skip memory", scene->skip_memory});
    series.facts.push_back({"volume path", scene->volume.path_reason()});
    for (const std::string& note : scene->volume.info().notes)
      series.facts.push_back({"volume", note});
  }
  if (makes_pictures(session) || session.clock.cost == "measured") {
    const std::string folder = labelled.label.empty() ? "images" : "images-" + file_part(labelled.label);
    auto rendered = std::make_unique<PixelWork>(PixelWork::Inputs{*device, session, headset, *scene,
                                                                  placement, options.data_folder,
                                                                  options.no_warp, vsyncs, run, folder});
    pixels = rendered.get();
    work = std::move(rendered);
  } else if (scene) {
    EyeRenderer renderer(*device, session, headset, *scene, placement, options.data_folder,
                         EyeRenderer::Counting::on);
    work = std::make_unique<CountedWork>(probe_work(
        renderer, *device, *scene, head, vsyncs, headset,
        PanelDisplay(*device, headset, session.pipeline.at("warp"), options.data_folder).work(), options));
    series.facts.push_back({"counted work", probe_fact(vsyncs)});
  } else if (session.clock.cost.rfind("recorded:", 0) == 0) {
    work = std::make_unique<RecordedWork>(session.clock.cost.substr(9));
    series.facts.push_back({"counted work", "that of the recorded run"});
  } else {
    work = std::make_unique<CountedWork>(std::vector<WorkProbe>{{SimTime(), {}, {}}});
    series.facts.push_back({"counted work", "none: nothing was rendered"});
  }
  FrameLoopConfig config = loop_config(session, headset, session.run.frames);
  if (scene) {
    config.transfer = scene->versions.schedule();
  } else {
    config.transfer = transfer_schedule(session.scene, headset.profile.refresh);
  }
  const NativeStage predict = live_stage(session.pipeline.at("predict"));
  const NativeStage control = live_stage(session.pipeline.at("control"));
  ProgressSink sink(series.records, vsyncs, options);
  const FrameLoopInputs inputs{head,
                               {&predict.predict_functions(), predict.self()},
                               {&control.control_functions(), control.self()},
                               *cost,
                               *work,
                               sink};
  series.loop = run_frame_loop(config, inputs);
  sink.finish();
  series.jobs = series.records.jobs_by_submission();
  if (pixels) series.pictures = pixels->pictures();
  return series;
}

}  // namespace brace
