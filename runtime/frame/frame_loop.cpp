#include "runtime/frame/frame_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "runtime/frame/describe_record.hpp"
#include "runtime/frame/frame_loop_state.hpp"

namespace brace {

using namespace frame_loop;

namespace {

SimDuration period_of(const Loop& loop) {
  return loop.clock.period_after(0);
}

SimTime photon_mid(const Loop& loop, std::int64_t vsync) {
  return loop.clock.time_of(vsync) + loop.photons.mid;
}

SimDuration warp_lead(const Loop& loop) {
  const FrameLoopConfig& config = loop.config;
  const SimDuration period = period_of(loop);
  if (config.warp_lead) return std::clamp(*config.warp_lead, SimDuration(0), period);
  SimDuration lead = loop.warp_costs.max_or(period / 4) + config.warp_margin;
  if (config.queue == QueueKind::priority)
    lead += config.preemption.granularity + config.preemption.switch_cost;
  return std::min(lead, period);
}

void expect_gpu_change(Loop& loop) {
  const std::optional<SimTime> change = loop.gpu.next_change();
  if (!change || (loop.gpu_event && *loop.gpu_event <= *change)) return;
  loop.gpu_event = std::max(*change, loop.events.now());
  loop.events.push(*loop.gpu_event, LoopEvent::gpu_change);
}

/// What a job costs that was begun at `begun`; by a wall clock it has just ended.
SimDuration cost_of(Loop& loop, const CostQuery& query, SimTime begun, SimDuration overhead) {
  if (loop.inputs.wall == nullptr) return loop.inputs.cost.cost(query) + overhead;
  loop.events.catch_up(loop.inputs.wall->now());
  return loop.events.now() - begun;
}

void submit(Loop& loop, JobKind kind, std::int64_t index, const JobOutcome& outcome, double share = 1.0,
            SimDuration overhead = SimDuration(0)) {
  const SimTime now = loop.events.now();
  const SimDuration cost = cost_of(loop,
                                   {.kind = kind,
                                    .index = index,
                                    .elapsed = now.time_since_epoch(),
                                    .work = outcome.work,
                                    .device_time = outcome.device_time,
                                    .share = share},
                                   now, overhead);
  loop.gpu.submit({.kind = kind, .index = index, .cost = cost, .work = outcome.work}, now);
  expect_gpu_change(loop);
}

bool swaps_cells(const Loop& loop) {
  return loop.chunked && loop.chunked->params().swap_cells;
}

/// How much later than its first photons an eye frame is aimed at.
SimDuration aim_offset(const Loop& loop) {
  if (loop.config.aim == Aim::first) return SimDuration(0);
  const SimDuration period = period_of(loop);
  return std::max(loop.frame_intervals.mean_or(period) - period, SimDuration(0)) / 2;
}

/// What a cast is asked for, from the newest pose.
CastRequest cast_request(Loop& loop, const EyeFrame& eye, std::span<const CellCuts> cuts) {
  const std::optional<ChunkedParams>& cells = loop.config.chunked;
  return {.frame = eye.frame,
          .slot = eye.slot,
          .world_from_head = eye.world_from_head,
          .start = loop.events.now(),
          .quality = eye.quality,
          .cell_columns = cells ? cells->columns : 0,
          .cell_rows = cells ? cells->rows : 0,
          .cuts = cuts,
          .gaze = eye.gaze};
}

/// Gives an eye frame, or a cell of it, the pose that the newest readings predict for its photons.
void aim_at(Loop& loop, EyeFrame& eye, SimTime target) {
  const std::span<const brace_tracker_sample> readings = loop.inputs.head.readings(loop.events.now());
  eye.world_from_head = predict(loop.inputs.predict, readings, target);
  eye.reading_ns = readings.back().time_ns;
  eye.target_ns = to_ns(target);
}

/// Whether cells are cast when they are submitted, one by one.
bool casts_cell_by_cell(const Loop& loop) {
  return loop.chunked && (loop.chunked->params().own_poses || loop.inputs.wall != nullptr);
}

/// Aims a cell at photons that it can still reach: its own, or those of its frame. The records name the pose
/// of the cell in the middle.
EyeFrame with_own_pose(Loop& loop, EyeFrame& eye) {
  EyeFrame now = eye;
  const SimTime next = photon_mid(loop, loop.clock.first_at_or_after(loop.events.now() + warp_lead(loop)));
  const SimTime own = next + aim_offset(loop);
  aim_at(loop, now, swaps_cells(loop) ? own : std::max(eye.aim, own));
  if (eye.cells_cast <= loop.chunked->cells() / 2) {
    eye.world_from_head = now.world_from_head;
    eye.reading_ns = now.reading_ns;
    eye.target_ns = now.target_ns;
  }
  return now;
}

CellOutcome cast_cell(Loop& loop, int cell) {
  EyeFrame& eye = *loop.casting;
  const EyeFrame seen = loop.chunked->params().own_poses ? with_own_pose(loop, eye) : eye;
  const CellOutcome outcome =
      loop.inputs.work.cast_cell({cast_request(loop, seen, loop.chunked->cuts()), cell});
  eye.work += outcome.work;
  ++eye.cells_cast;
  return outcome;
}

/// Of a frame's work; what that will be is not known before its last cell: as in the frame before.
double share_of(const Loop& loop, const CellOutcome& cell) {
  const std::uint64_t samples = loop.front ? loop.front->work.samples : 0;
  return samples > 0 ? static_cast<double>(cell.work.samples) / static_cast<double>(samples)
                     : 1.0 / loop.chunked->cells();
}

/// Cells of the eye frame at hand, as many as fit before the next warp is submitted.
void submit_cells(Loop& loop) {
  if (!loop.chunked || !loop.casting) return;
  const SimTime vsync = loop.clock.time_of(loop.next_deadline_vsync);
  const ChunkedParams& params = loop.chunked->params();
  const SimTime deadline = vsync - std::min(params.reserve.value_or(warp_lead(loop)), period_of(loop));
  const bool warp_runs = loop.next && loop.next->done_ns < 0;
  loop.chunked->submit_what_fits(
      loop.events.now(), deadline, !warp_runs || loop.config.queue == QueueKind::dual,
      [&](const ChunkedCast::CellJob& cell) {
        const bool now = casts_cell_by_cell(loop);
        const CellOutcome outcome = now ? cast_cell(loop, cell.cell) : cell.outcome;
        submit(loop, JobKind::cast, cell.frame, {outcome.work, outcome.device_time},
               now ? share_of(loop, outcome) : cell.share, params.cell_overhead);
      });
}

/// The vsync where the newest finished frame is seen first, as known now; -1 if there is none.
std::int64_t claimed_vsync(const Loop& loop) {
  if (!loop.front) return -1;
  return loop.front_seen_vsync >= 0 ? loop.front_seen_vsync : loop.next_latch_vsync;
}

/// The vsync where a frame started now is expected to be seen first.
std::int64_t expect_vsync(Loop& loop) {
  const SimTime done = loop.events.now() + loop.cast_durations.mean_or(SimDuration(0));
  std::int64_t vsync = loop.clock.first_at_or_after(done + warp_lead(loop));
  const std::int64_t claimed = claimed_vsync(loop);
  if (loop.config.pace == Pace::vsync) vsync = std::max(vsync, claimed + 1);
  if (vsync <= claimed) ++loop.result.duplicate_predictions;
  if (vsync <= loop.last_predicted_vsync) ++loop.result.revised_predictions;
  loop.last_predicted_vsync = vsync;
  return vsync;
}

/// Brings the GPU to the transfer function in force, before the cast that shows it first.
void update_transfer(Loop& loop) {
  const SimTime now = loop.events.now();
  const std::int64_t version = loop.config.transfer.version_at(now);
  if (version == loop.transfer_version) return;
  loop.transfer_version = version;
  ++loop.result.transfer_updates;
  const std::int64_t frame = loop.result.eye_frames_started;
  submit(loop, JobKind::update, frame,
         loop.inputs.work.update({.frame = frame, .transfer_version = version, .start = now}));
}

void start_eye_frame(Loop& loop) {
  update_transfer(loop);
  const SimTime now = loop.events.now();
  EyeFrame eye;
  eye.frame = loop.result.eye_frames_started++;
  eye.aim = photon_mid(loop, expect_vsync(loop)) + aim_offset(loop);
  aim_at(loop, eye, eye.aim);
  eye.slot = loop.front && !swaps_cells(loop) ? (loop.front->slot + 1) % frame_slots : 0;
  eye.begin = now;
  eye.quality = loop.quality;
  if (loop.inputs.gaze != nullptr) eye.gaze = loop.inputs.gaze->known_at(now);
  const std::span<const CellCuts> cuts = loop.chunked ? loop.chunked->cut() : std::span<const CellCuts>();
  const JobOutcome outcome =
      casts_cell_by_cell(loop) ? JobOutcome() : loop.inputs.work.cast(cast_request(loop, eye, cuts));
  eye.work = outcome.work;
  loop.casting = eye;
  if (loop.chunked) {
    loop.chunked->begin_frame(eye.frame, outcome);
    submit_cells(loop);
  } else {
    submit(loop, JobKind::cast, eye.frame, outcome);
  }
}

/// Where the head will be at the first and the last line's photons, from the newest readings.
ScanPoses predict_scan(Loop& loop, std::int64_t vsync) {
  const SimTime time = loop.clock.time_of(vsync);
  const std::span<const brace_tracker_sample> readings = loop.inputs.head.readings(loop.events.now());
  return {predict(loop.inputs.predict, readings, time + loop.photons.first_row),
          predict(loop.inputs.predict, readings, time + loop.photons.last_row)};
}

/// The front buffer. With cells of the next frame in it, it is named after the pose of that one's middle as
/// soon as it is there.
EyeFrame eye_frame_shown(const Loop& loop) {
  EyeFrame shown = *loop.front;
  if (swaps_cells(loop) && loop.casting && loop.casting->cells_cast > loop.chunked->cells() / 2) {
    shown.world_from_head = loop.casting->world_from_head;
    shown.reading_ns = loop.casting->reading_ns;
    shown.target_ns = loop.casting->target_ns;
  }
  return shown;
}

/// Takes the newest finished eye frame and, for warps that use one, the newest pose.
void latch_warp(Loop& loop, std::int64_t vsync) {
  if (!loop.front || loop.next) return;  // nothing to show yet, or a late image goes first
  const bool uses_pose = loop.config.warp_pose != WarpPose::none;
  const bool seen = loop.panel && loop.panel->eye.frame == loop.front->frame && !swaps_cells(loop);
  if (!uses_pose && seen) return;  // the panel repeats it

  const SimTime now = loop.events.now();
  vsync = std::max(vsync, loop.clock.first_at_or_after(now));  // later by a wall clock alone
  DisplayImage image;
  image.eye = eye_frame_shown(loop);
  image.warp_world_from_head = image.eye.world_from_head;
  image.reading_ns = image.eye.reading_ns;
  if (uses_pose) {
    const std::span<const brace_tracker_sample> readings = loop.inputs.head.readings(now);
    image.warp_world_from_head = predict(loop.inputs.predict, readings, photon_mid(loop, vsync));
    image.reading_ns = readings.back().time_ns;
  }
  WarpRequest request{.vsync_index = vsync,
                      .frame = image.eye.frame,
                      .slot = image.eye.slot,
                      .render_world_from_head = image.eye.world_from_head,
                      .warp_world_from_head = image.warp_world_from_head,
                      .start = now};
  if (uses_pose && loop.config.scan_poses) request.warp_scan = predict_scan(loop, vsync);
  const JobOutcome outcome = loop.inputs.work.warp(request);
  loop.next = image;
  if (loop.front_seen_vsync < 0) loop.front_seen_vsync = vsync;
  ++loop.result.warps;
  submit(loop, JobKind::warp, vsync, outcome);
}

/// The time for cells is that between two warps.
void begin_cell_period(Loop& loop, std::int64_t latched_vsync) {
  if (!loop.chunked) return;
  loop.next_deadline_vsync = latched_vsync + 1;
  loop.chunked->begin_period();
  submit_cells(loop);
}

void control_quality(Loop& loop, std::int64_t frame, std::int64_t cost_ns) {
  const ControlStage& control = loop.inputs.control;
  if (control.functions == nullptr) return;
  const brace_control_input input{.struct_size = sizeof(brace_control_input),
                                  .frame = static_cast<std::uint64_t>(frame),
                                  .frame_cost_ns = cost_ns,
                                  .budget_ns = to_ns(period_of(loop) - warp_lead(loop)),
                                  .missed = loop.missed_since_control,
                                  .delay_frames = 0};  // the next frame starts after this
  double quality = 0;
  const brace_result result = control.functions->update(control.self, &input, &quality);
  if (result != BRACE_OK || !(quality > 0 && quality <= 1)) {
    const bool has_words = result != BRACE_OK && control.last_error != nullptr;
    const char* own_words = has_words ? control.last_error(control.self) : nullptr;
    throw device_error(
        "{} failed in update; expected BRACE_OK and 0 < quality <= 1; found result {}, quality {} after "
        "frame {}{}{}",
        control.name, static_cast<int>(result), quality, frame, own_words != nullptr ? ": " : "",
        own_words != nullptr ? own_words : "");
  }
  loop.quality = quality;
  loop.missed_since_control = 0;
}

void finish_cast(Loop& loop, const JobRecord& job) {
  BRACE_CHECK(loop.casting && loop.casting->frame == job.index);
  if (loop.front) loop.frame_intervals.add(SimDuration(job.end_ns - loop.front->done_ns));
  loop.front = loop.casting;
  loop.front->start_ns = job.start_ns;
  loop.front->done_ns = job.end_ns;
  loop.front_seen_vsync = -1;
  loop.casting.reset();
  ++loop.result.eye_frames_finished;
  loop.cast_durations.add(SimDuration(job.end_ns - job.submit_ns));
  control_quality(loop, job.index, job.cost_ns);
  if (loop.config.pace == Pace::free) {
    const SimTime earliest = sim_time(job.submit_ns) + free_frame_interval_min;
    loop.events.push(std::max(loop.events.now(), earliest), LoopEvent::start_eye_frame);
  }
}

/// A late frame in cells, between two of them: told to the control stage once, and given up if a frame of the
/// quality that this asks for is done sooner than the rest of it.
void give_up_late_frame(Loop& loop) {
  if (!loop.chunked || !loop.casting || loop.casting->judged) return;
  const int periods = loop.chunked->params().give_up_periods;
  if (periods == 0 || loop.events.now() < loop.casting->begin + periods * period_of(loop)) return;
  const std::optional<ChunkedCast::Expected> cost = loop.chunked->expected_cost();
  if (!cost) return;
  loop.casting->judged = true;
  ++loop.missed_since_control;  // of the eye frame, whatever warps made of the vsync
  control_quality(loop, loop.casting->frame, to_ns(cost->total));
  const double anew_ns = static_cast<double>(to_ns(cost->total)) * loop.quality / loop.casting->quality;
  if (!(anew_ns < static_cast<double>(to_ns(cost->left)))) return;
  loop.chunked->give_up(loop.inputs.sink);
  loop.casting.reset();
  ++loop.result.eye_frames_given_up;
  start_eye_frame(loop);
}

void finish_warp(Loop& loop, const JobRecord& job) {
  BRACE_CHECK(loop.next.has_value());
  loop.next->start_ns = job.start_ns;
  loop.next->done_ns = job.end_ns;
  loop.warp_costs.add(SimDuration(job.cost_ns));
}

void collect_finished(Loop& loop) {
  loop.gpu.advance(loop.events.now());
  while (const std::optional<JobRecord> job = loop.gpu.take_finished()) {
    if (job->kind == JobKind::cast && loop.chunked) {
      if (const auto whole = loop.chunked->finish_cell(*job, loop.inputs.sink)) finish_cast(loop, *whole);
      continue;
    }
    if (loop.chunked) loop.chunked->flush(loop.inputs.sink);  // rows in the order of time
    loop.inputs.sink.add(*job);
    if (job->kind == JobKind::cast) finish_cast(loop, *job);
    if (job->kind == JobKind::warp) finish_warp(loop, *job);
  }
  give_up_late_frame(loop);
  submit_cells(loop);
  expect_gpu_change(loop);
}

/// Scans out the image that is ready, or the last one again.
void show_vsync(Loop& loop, std::int64_t vsync) {
  const SimTime now = loop.clock.time_of(vsync);
  const bool image_is_new = loop.next && loop.next->done_ns >= 0 && loop.next->done_ns <= to_ns(now);
  if (image_is_new) {
    loop.panel = loop.next;
    loop.next.reset();
  }
  FrameRecord record;
  record.vsync_index = vsync;
  record.vsync_ns = to_ns(now);
  record.photon_first_row_ns = to_ns(now + loop.photons.first_row);
  record.photon_mid_ns = to_ns(now + loop.photons.mid);
  record.photon_last_row_ns = to_ns(now + loop.photons.last_row);
  record.pose_valid = loop.inputs.head.valid_at(now + loop.photons.mid);
  if (loop.panel) {
    record.missed = !image_is_new;
    loop.stale_run = record.missed ? loop.stale_run + 1 : 0;
    loop.missed_since_control += record.missed ? 1 : 0;
    record.stale_run = loop.stale_run;
    describe_image(record, *loop.panel, loop.config.warp_pose);
    const Pose truth = loop.inputs.head.true_pose(now + loop.photons.mid);
    if (record.pose_valid) describe_error(record, shown_pose(*loop.panel, loop.config.warp_pose), truth);
    const glm::dvec3 gaze =
        describe_gaze(record, loop.inputs.gaze, loop.panel->eye.gaze, now + loop.photons.mid);
    ShowRequest request{.vsync_index = vsync,
                        .image_is_new = image_is_new,
                        .true_world_from_head = truth,
                        .transfer_version = loop.config.transfer.version_at(now + loop.photons.mid),
                        .true_gaze = gaze};
    if (loop.config.scan_poses)
      request.true_scan = {loop.inputs.head.true_pose(now + loop.photons.first_row),
                           loop.inputs.head.true_pose(now + loop.photons.last_row)};
    loop.inputs.work.show(request);
  }
  loop.inputs.sink.add(record);
  ++loop.result.vsyncs;
}

void on_vsync(Loop& loop, std::int64_t vsync) {
  show_vsync(loop, vsync);
  if (vsync + 1 == loop.vsync_count) return;
  loop.next_latch_vsync = vsync + 1;
  // schedule/whole_frame: one job per eye frame. A chunked schedule submits its cells here instead.
  const SimTime next = loop.clock.time_of(vsync + 1);
  const bool overdue = loop.events.now() >= next;  // by a wall clock: a later one is due, too
  const bool starts = vsync == 0 || (loop.config.pace == Pace::vsync && !loop.casting && !overdue);
  if (starts) start_eye_frame(loop);
  // By a wall clock they may be late already; then they go before what is not.
  loop.events.push(std::max(loop.clock.time_of(vsync), next - warp_lead(loop)), LoopEvent::latch_warp,
                   vsync + 1);
  loop.events.push(next, LoopEvent::vsync, vsync + 1);
}

/// Vsyncs whose middle photon time the trace covers, at most vsyncs_max.
std::int64_t count_vsyncs(Loop& loop) {
  const std::optional<std::int64_t>& asked = loop.config.vsyncs_max;
  const SimTime end = loop.inputs.head.end_time();
  if (end == SimTime::max()) {
    if (!asked) throw input_error("a looping trace has no end: say how many vsyncs to replay (--frames N)");
    return *asked;
  }
  const std::int64_t covered = loop.clock.last_at_or_before(end - loop.photons.mid) + 1;
  if (covered <= 0) {
    throw input_error("the trace ends {:.3f} ms after the start; the first vsync's photons are at {:.3f} ms",
                      to_s(end) * 1e3, to_s(loop.photons.mid) * 1e3);
  }
  loop.result.trace_ended = !asked || covered <= *asked;
  return asked ? std::min(covered, *asked) : covered;
}

Event<LoopEvent> next_event(Loop& loop) {
  const Event<LoopEvent> event = loop.events.pop();
  if (loop.inputs.wall == nullptr) return event;
  loop.inputs.wall->wait_until(event.time);
  loop.events.catch_up(loop.inputs.wall->now());
  return event;
}

PhotonOffsets photon_offsets(const Display& display) {
  const SimTime zero = sim_time(0);
  const sim::PhotonTimes times =
      sim::photon_times(zero, display.scan_out, display.refresh, display.emission, display.scan_lines);
  return {times.first_row - zero, times.mid - zero, times.last_row - zero};
}

}  // namespace

FrameLoopResult run_frame_loop(const FrameLoopConfig& config, const FrameLoopInputs& inputs) {
  BRACE_CHECK(inputs.predict.functions != nullptr);
  BRACE_CHECK(inputs.wall == nullptr || config.queue == QueueKind::single);
  Loop loop(config, inputs);
  loop.photons = photon_offsets(config.display);
  loop.vsync_count = count_vsyncs(loop);
  if (loop.vsync_count <= 0) throw input_error("--frames is {}; accepted: 1 or more", loop.vsync_count);

  loop.events.push(loop.clock.time_of(0), LoopEvent::vsync, 0);
  while (loop.result.vsyncs < loop.vsync_count) {
    const Event<LoopEvent> event = next_event(loop);
    if (loop.gpu_event == event.time && event.kind == LoopEvent::gpu_change) loop.gpu_event.reset();
    collect_finished(loop);  // ends at this very time count, whatever the order of events
    switch (event.kind) {
      case LoopEvent::vsync:
        on_vsync(loop, event.data);
        break;
      case LoopEvent::latch_warp:
        latch_warp(loop, event.data);
        begin_cell_period(loop, event.data);
        break;
      case LoopEvent::start_eye_frame:
        start_eye_frame(loop);
        break;
      case LoopEvent::gpu_change:
        break;
    }
  }
  if (loop.chunked) loop.chunked->flush(inputs.sink);
  for (JobRecord job : loop.gpu.unfinished()) {
    job.ends_frame = job.ends_frame && !(loop.chunked && job.kind == JobKind::cast);
    inputs.sink.add(job);
  }
  loop.result.events = loop.events.processed();
  return loop.result;
}

}  // namespace brace
