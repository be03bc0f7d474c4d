#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/time.hpp"
#include "hmd_sim/vsync.hpp"
#include "plugins/abi/brace_stage.h"
#include "runtime/frame/cell_schedule.hpp"
#include "runtime/frame/frame_work.hpp"
#include "runtime/frame/gaze_motion.hpp"
#include "runtime/frame/head_motion.hpp"
#include "runtime/frame/record_sink.hpp"
#include "runtime/frame/transfer_schedule.hpp"
#include "runtime/timeline/cost_source.hpp"
#include "runtime/timeline/simulated_gpu.hpp"
#include "runtime/timeline/wall_clock.hpp"

namespace brace {

/// The display side of a headset. Build it with display_of(profile) or by hand in tests.
struct Display {
  sim::Rate refresh;
  sim::ScanOut scan_out;
  sim::Emission emission;
  int scan_lines = 1;
};

/// What the warp stage takes from the pose latched for it; the rest comes from the eye frame's render pose.
enum class WarpPose {
  none,                     // warp/none: shows the eye frame as it is
  rotation,                 // warp/quad
  rotation_and_translation  // warps that know depth
};

/// When schedule/whole_frame starts the next eye frame.
enum class Pace {
  vsync,  // at the first vsync after the frame before is done, as a compositor paces an app
  free    // at once, but not within free_frame_interval_min of the start before
};

/// For which of the vsyncs that an eye frame is seen at its pose is predicted.
enum class Aim {
  first,  // the first
  middle  // the middle of the time it is expected to be seen: late warps have the least to make up
};

inline constexpr SimDuration free_frame_interval_min{100'000};

struct FrameLoopConfig {
  Display display;
  std::optional<std::int64_t> vsyncs_max;  // default: until the trace ends
  QueueKind queue = QueueKind::single;
  PreemptionParams preemption;
  Pace pace = Pace::vsync;
  Aim aim = Aim::first;
  std::optional<ChunkedParams> chunked;  // schedule/chunked; default: schedule/whole_frame
  WarpPose warp_pose = WarpPose::rotation;
  /// How long before its vsync a warp latches its pose and is submitted. Default: the dearest of the last
  /// 8 warps (before the first: a quarter of a period) + warp_margin, on a priority queue + granularity + a
  /// switch. Never more than a period.
  std::optional<SimDuration> warp_lead;
  SimDuration warp_margin{500'000};
  TransferSchedule transfer;  // when the scene's transfer function changes
  bool scan_poses = false;    // requests carry the poses of the first and last line, too
};

/// Stages the loop itself calls, through the C ABI. Not owned.
struct PredictStage {
  const brace_predict_functions* functions = nullptr;
  void* self = nullptr;
  std::string name = "the predict stage";  // file and stage, for messages
};
struct ControlStage {  // functions == nullptr: full quality always
  const brace_control_functions* functions = nullptr;
  void* self = nullptr;
  std::string name = "the control stage";
  const char* (*last_error)(void* self) = nullptr;  // may be null
};

struct FrameLoopInputs {
  HeadMotion& head;
  PredictStage predict;
  ControlStage control;
  CostSource& cost;
  FrameWork& work;
  RecordSink& sink;
  GazeMotion* gaze = nullptr;  // none: straight ahead, always
  /// The run goes by this clock, whose 0 is vsync 0, and a job takes what its call took on it; `cost` is not
  /// asked. With QueueKind::single alone: one thread does it all. None: simulated time.
  WallClock* wall = nullptr;
};

struct FrameLoopResult {
  std::int64_t vsyncs = 0;
  bool trace_ended = false;  // the trace, not vsyncs_max, ended the run
  std::int64_t eye_frames_started = 0;
  std::int64_t eye_frames_finished = 0;
  std::int64_t warps = 0;
  std::int64_t transfer_updates = 0;
  std::int64_t eye_frames_given_up = 0;  // ChunkedParams::give_up_periods
  /// Eye frames whose pose was predicted for a vsync at which, as was known when they were started, the frame
  /// before them is seen. Always 0 with Pace::vsync; with Pace::free frames faster than the display share
  /// vsyncs.
  std::int64_t duplicate_predictions = 0;
  /// Eye frames predicted for a vsync not later than the frame before them was predicted for: that one was
  /// done sooner than expected and seen earlier (a load that drops). 0 under steady load.
  std::int64_t revised_predictions = 0;
  std::uint64_t events = 0;  // of the timeline: host work is proportional to it
};

/// Replays a head motion: run time 0 is vsync 0.
///
/// Eye frames. At its start a frame takes the newest tracker readings and is cast from the pose predicted for
/// the middle of the photons of the vsync where it is expected to be seen first: start + mean of the last 8
/// frame durations (nothing before the first), the first vsync whose warp latches after that, and with
/// Pace::vsync later than the one where the frame before is seen. Finished by the GPU it is the front buffer.
/// With Aim::middle it is predicted for later by half of what it is expected to be seen longer than a period.
///
/// Chunked. An eye frame is cast in cells (CellSchedule), all from the pose of its start, or with own_poses
/// each from the pose that the newest readings predict, when it is submitted, for the photons aimed at (later
/// ones once those cannot be reached any more); records then name the pose of the cell in the middle. With
/// swap_cells the front buffer is where cells are cast into, each for the first photons that it can reach.
/// Between the submission of one warp and of the next as many as fit, at least one. What is left of the frame
/// waits; it is the front buffer when its last cell is done. With give_up_periods a frame that takes longer
/// is told to the control stage as a miss, with the cost that its cells so far let expect; if a frame of the
/// quality that it then asks for would be done sooner than the rest of this one, the rest is not cast, and
/// that one starts at once.
///
/// Transfer function. An eye frame shows the version in force when it is started. If that is another one than
/// the frame before it showed, an update job goes to the GPU right before its cast; versions that no frame
/// starts in are passed over.
///
/// Display. A lead before vsync k the warp takes the newest finished eye frame and, if it uses a pose, the
/// newest readings, predicted for the middle of vsync k's photons. Done by the vsync, its image is scanned
/// out; otherwise the panel repeats its image and the late one is shown at the first vsync after its end; no
/// other warp starts before. warp/none has no job while there is no new eye frame.
///
/// Wall clock. The same, at the pace of a clock that goes on by itself: events are waited for, and a job that
/// takes long makes what follows late. Eye frames in cells are asked for cell by cell, whatever their poses.
/// A warp that comes to its turn after its vsync is one for the next.
///
/// missed: nothing new was latched at this vsync. For warps with a pose: no warp was done in time. For
/// warp/none: the same eye frame again, too. Vsyncs before the first image (displayed_frame -1) are start-up,
/// not missed. The run ends at the last vsync whose middle photon time the trace covers, or at vsyncs_max.
///
/// Throws input_error if not a single vsync fits the trace, device_error if a stage fails.
FrameLoopResult run_frame_loop(const FrameLoopConfig& config, const FrameLoopInputs& inputs);

}  // namespace brace
