#include "runtime/replay/series.hpp"

#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "runtime/replay/gaze_source.hpp"
#include "runtime/replay/series_facts.hpp"
#include "runtime/replay/series_work.hpp"
#include "runtime/replay/stage_instance.hpp"
#include "runtime/report/progress.hpp"

namespace brace {

namespace {

/// `stage` is where a plug-in's cost stage lives.
std::unique_ptr<CostSource> make_cost(const Session& session, const std::filesystem::path& data_folder,
                                      std::optional<NativeStage>& stage) {
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
  if (const auto chosen = session.pipeline.find("cost"); chosen != session.pipeline.end()) {
    stage.emplace(live_stage(chosen->second));
    return make_plugin_cost(stage->cost_functions(), stage->self(), stage->place(), pixel_scale,
                            clock.cost_scale);
  }
  const std::string name = clock.cost.substr(clock.cost.find(':') + 1);
  if (clock.cost.rfind("recorded:", 0) == 0) return make_recorded_cost(name, clock.cost_scale);
  return make_model_cost(find_cost_model(data_folder / "costs", name), pixel_scale, clock.cost_scale);
}

std::optional<ChunkedParams> chunked_params(const PipelineStage& schedule) {
  if (schedule.stage.id() != "schedule/chunked") return {};
  ChunkedParams params;
  params.columns = static_cast<int>(schedule.value("columns"));
  params.rows = static_cast<int>(schedule.value("rows"));
  params.guard = static_cast<ChunkedParams::Guard>(static_cast<int>(schedule.value("guard")));
  params.order = static_cast<ChunkedParams::Order>(static_cast<int>(schedule.value("order")));
  params.cut = static_cast<ChunkedParams::Cut>(static_cast<int>(schedule.value("cut")));
  params.own_poses = cells_have_poses(schedule);
  params.swap_cells = schedule.value("swap") == 1.0;
  params.bias = schedule.value("bias");
  if (schedule.value("reserve_ms") > 0.0) params.reserve = from_s(schedule.value("reserve_ms") * 1e-3);
  params.cell_overhead = from_s(schedule.value("cell_overhead_us") * 1e-6);
  params.give_up_periods = static_cast<int>(schedule.value("give_up_periods"));
  return params;
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
  const PipelineStage& schedule = session.pipeline.at("schedule");
  config.pace = schedule.value("pace") == 0.0 ? Pace::vsync : Pace::free;
  config.aim = schedule.value("aim") == 0.0 ? Aim::first : Aim::middle;
  config.chunked = chunked_params(schedule);
  config.warp_pose = warp_pose_of(session.pipeline.at("warp"));
  config.scan_poses = session.output.ideal_by_line || warps_by_line(session.pipeline.at("warp"));
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
void apply_skip_choice(const SeriesWork& work, Series& series) {
  if (!work.scene || work.scene->skip_reason.empty()) return;
  const SceneOnDevice& scene = *work.scene;
  for (StageChoice& choice : series.pipeline)
    if (choice.family == "skip") choice.stage = scene.skip_stage.stage.id();
  series.facts.push_back({"skip/auto", scene.skip_reason});
  if (!scene.skip) series.left_out.push_back({"skip", scene.skip_reason});
}

/// A device or stage that fails in the middle leaves what was recorded before.
void run_until_failure(const FrameLoopConfig& config, const FrameLoopInputs& inputs, Series& series) {
  try {
    series.loop = run_frame_loop(config, inputs);
  } catch (const Error& error) {
    if (error.exit_code() != ExitCode::device_or_plugin_failed || series.records.frames().empty()) throw;
    series.failure = error.what();
  }
}

/// A device that fails while the last errors are measured leaves those of vsyncs before.
void take_errors(ErrorMeter& meter, Series& series) {
  try {
    meter.finish();
  } catch (const Error& error) {
    if (error.exit_code() != ExitCode::device_or_plugin_failed) throw;
    if (series.failure.empty()) series.failure = error.what();
  }
  for (const ErrorMeter::VsyncErrors& one : meter.errors())
    if (one.vsync_index < static_cast<std::int64_t>(series.records.frames().size()))
      series.records.set_errors(one.vsync_index, one.errors);
  if (const std::string note = meter.note(); !note.empty()) series.facts.push_back({"ideal pictures", note});
}

/// What the watchdog saw, and the jobs over their deadline, each under the stage it was the job of.
std::vector<WatchdogReport> find_faults(Watchdog& watchdog, const Session& session, const Headset& headset,
                                        std::span<const JobRecord> jobs) {
  const double deadline_ms = session.run.deadline_ms.value_or(1e3 / headset.profile.refresh.hz());
  const std::int64_t deadline_ns = to_ns(from_s(deadline_ms * 1e-3));
  for (const JobRecord& job : jobs) {
    const char* family = job.kind == JobKind::cast ? "cast" : job.kind == JobKind::warp ? "warp" : "skip";
    watchdog.job_done(session.pipeline.at(family).stage.id(), job.index, job.cost_ns, deadline_ns);
  }
  return watchdog.reports();
}

/// What the warp had to make up; nothing for warps that do not know depth.
void add_fill_facts(const Session& session, const PanelDisplay& display, Series& series) {
  if (!display.fills() || display.images() == 0) return;
  const DisplayPipeline::Counts counts = display.counted();
  const double pixels = static_cast<double>(display.work().texels) * static_cast<double>(display.images());
  series.facts.push_back(
      {session.pipeline.at("warp").stage.id(),
       fmt::format("{:.3f} % of the panels' pixels {}, {:.3f} % beyond the eye frame",
                   100.0 * static_cast<double>(counts.filled) / pixels,
                   display.counts_work() ? "look behind what stopped a ray" : "filled behind edges",
                   100.0 * static_cast<double>(counts.uncovered) / pixels)});
}

}  // namespace

Series replay_series(const LabelledSession& labelled, const ReplayOptions& options, const Headset& headset,
                     const HeadTrace& head_trace, const gpu::Device* device, RunDirectory& run,
                     IdealCache& ideals) {
  const Session& session = labelled.session;
  Series series;
  series.label = labelled.label;
  series.pipeline = stage_choices(session);
  series.left_out = labelled.left_out;
  for (LeftOut& one : left_out(session, headset))
    series.left_out.push_back(std::move(one));

  const SimTime start = head_trace.trace.begin_time() + from_s(session.trace.start_s);
  HeadMotion head(
      head_trace.trace,
      session.trace.interpolation == "slerp" ? sim::Interpolation::slerp_linear : sim::Interpolation::hermite,
      headset.profile.tracker, session.run.seed, session.trace.loop, start);
  if (session.trace.loop && !session.run.frames) {
    throw input_error("{}: 'trace.loop' runs without end; say how long with 'run.frames' or --frames",
                      session.file.string());
  }
  std::optional<GazeMotion> gaze = make_gaze(session, head_trace.trace, head);
  const std::int64_t vsyncs = vsync_count(session, headset, head);
  const VolumePlacement placement = place_volume(session.scene, head.true_pose(SimTime()));

  std::optional<NativeStage> cost_stage;
  const std::unique_ptr<CostSource> cost = make_cost(session, options.data_folder, cost_stage);
  series.deterministic = cost->deterministic();

  SeriesWork work = make_work({session, options, headset, head, placement, device, vsyncs, run,
                               labelled.label, ideals, gaze ? &*gaze : nullptr});
  apply_skip_choice(work, series);
  series.facts.insert(series.facts.end(), work.facts.begin(), work.facts.end());
  series.host_facts = work.host_facts;
  if (!session.cast_reason.empty()) series.facts.push_back({"cast/auto", session.cast_reason});
  series.left_out.insert(series.left_out.end(), work.left_out.begin(), work.left_out.end());
  series.stereo_layer_mib = work.stereo_layer_mib;
  FrameLoopConfig config = loop_config(session, headset, session.run.frames);
  config.transfer = work.scene ? work.scene->versions.schedule()
                               : transfer_schedule(session.scene, headset.profile.refresh);
  const NativeStage predict = live_stage(session.pipeline.at("predict"));
  const NativeStage control = live_stage(session.pipeline.at("control"));
  ProgressSink sink(series.records, vsyncs, options);
  std::optional<HostClock> wall;
  if (session.clock.wall) wall.emplace();  // the first vsync is now
  const FrameLoopInputs inputs{
      head,
      {&predict.predict_functions(), predict.self(), predict.place()},
      {&control.control_functions(), control.self(), control.place(), control.last_error()},
      *cost,
      *work.frame_work,
      sink,
      gaze ? &*gaze : nullptr,
      wall ? &*wall : nullptr};
  run_until_failure(config, inputs, series);
  sink.finish();
  if (work.pixels != nullptr && work.pixels->error_meter() != nullptr)
    take_errors(*work.pixels->error_meter(), series);
  if (config.chunked && config.chunked->give_up_periods > 0) {
    series.facts.push_back({"eye frames given up",
                            fmt::format("{} of {} started: load control wanted fewer rays",
                                        series.loop.eye_frames_given_up, series.loop.eye_frames_started)});
  }
  series.jobs = series.records.jobs_by_submission();
  if (work.watchdog != nullptr) series.faults = find_faults(*work.watchdog, session, headset, series.jobs);
  if (work.pixels != nullptr) {
    series.pictures = work.pixels->pictures();
    if (const std::string note = work.pixels->renderer().stereo_note(); !note.empty())
      series.facts.push_back({session.pipeline.at("stereo").stage.id() + ", frames", note});
    add_fill_facts(session, work.pixels->display(), series);
  }
  return series;
}

}  // namespace brace
