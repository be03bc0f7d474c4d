#pragma once

#include <optional>

#include "runtime/frame/chunked_cast.hpp"
#include "runtime/frame/frame_loop.hpp"
#include "runtime/frame/recent_durations.hpp"
#include "runtime/timeline/event_queue.hpp"

// What run_frame_loop knows while it runs; of frame_loop.cpp alone.

namespace brace::frame_loop {

enum class LoopEvent { vsync, latch_warp, start_eye_frame, gpu_change };

/// An eye frame: asked for, and with `done` the front buffer.
struct EyeFrame {
  std::int64_t frame = -1;
  Pose world_from_head;
  std::int64_t reading_ns = -1;  // the newest tracker reading it was predicted from
  std::int64_t target_ns = -1;   // photon time it was predicted for
  std::int64_t start_ns = -1;    // first work on the GPU
  std::int64_t done_ns = -1;
  WorkCounts work;
  glm::dvec3 gaze = sim::straight_ahead;  // as known at its start
  int slot = 0;                           // of the swap-chain
  SimTime begin{};                        // when it was asked for
  double quality = 1.0;
  bool judged = false;  // the control stage has been told that it is late
  SimTime aim{};        // photon time it was predicted for at its start
  int cells_cast = 0;   // from poses of their own
};

/// What a warp makes of an eye frame: on its way to the panel, or on it.
struct DisplayImage {
  EyeFrame eye;
  Pose warp_world_from_head;
  std::int64_t reading_ns = -1;  // of the latched pose; the eye frame's for warps without one
  std::int64_t start_ns = -1;
  std::int64_t done_ns = -1;  // -1 while the GPU works on it
};

struct PhotonOffsets {
  SimDuration first_row, mid, last_row;  // from the vsync; the same for every vsync
};

struct Loop {
  Loop(const FrameLoopConfig& loop_config, const FrameLoopInputs& loop_inputs)
      : config(loop_config),
        inputs(loop_inputs),
        clock(SimTime(SimDuration(0)), loop_config.display.refresh),
        gpu(loop_config.queue, loop_config.preemption) {
    if (loop_config.chunked) chunked.emplace(*loop_config.chunked);
  }

  const FrameLoopConfig& config;
  const FrameLoopInputs& inputs;
  sim::VsyncClock clock;
  PhotonOffsets photons{};
  std::int64_t vsync_count = 0;
  EventQueue<LoopEvent> events;
  SimulatedGpu gpu;
  std::optional<SimTime> gpu_event;  // earliest change that an event waits for

  std::optional<ChunkedCast> chunked;

  std::optional<EyeFrame> casting;   // at most one
  std::optional<EyeFrame> front;     // newest finished
  std::optional<DisplayImage> next;  // the one image between latch and vsync
  std::optional<DisplayImage> panel;

  RecentDurations cast_durations, warp_costs;
  RecentDurations frame_intervals;  // between ends of eye frames
  double quality = 1.0;
  std::uint32_t missed_since_control = 0;
  std::int32_t stale_run = 0;
  std::int64_t next_latch_vsync = 0;     // the vsync that the next warp latches for
  std::int64_t next_deadline_vsync = 1;  // whose warp cells must leave time for
  std::int64_t front_seen_vsync = -1;    // that the front buffer was first latched for; -1: not yet
  std::int64_t last_predicted_vsync = -1;
  std::int64_t transfer_version = 0;  // that eye frames show
  FrameLoopResult result;
};

/// The pose that a predict stage expects at `target`. Throws device_error where it fails or gives none.
Pose predict(const PredictStage& stage, std::span<const brace_tracker_sample> readings, SimTime target);

/// What the eye gets of an image: rotation and translation may come from different poses.
Pose shown_pose(const DisplayImage& image, WarpPose warp_pose);

void describe_image(FrameRecord& record, const DisplayImage& image, WarpPose warp_pose);

}  // namespace brace::frame_loop
