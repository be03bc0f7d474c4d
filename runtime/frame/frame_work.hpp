#pragma once

#include <cstdint>

#include "base/pose.hpp"
#include "base/time.hpp"
#include "runtime/metrics/frame_record.hpp"

namespace brace {

/// An eye frame asked of the raycaster: both eyes, seen from one predicted head pose, into a swap-chain slot.
struct CastRequest {
  std::int64_t frame = 0;
  int slot = 0;  // 0 .. frame_slots - 1
  Pose world_from_head;
  SimTime start;
};

/// One display image: the newest finished eye frame, re-projected to the newest pose and distorted.
struct WarpRequest {
  std::int64_t vsync_index = 0;
  std::int64_t frame = 0;
  int slot = 0;
  Pose render_world_from_head;
  Pose warp_world_from_head;
};

/// A vsync whose photons are out: what was shown, and where the head truly was at photon time.
struct ShowRequest {
  std::int64_t vsync_index = 0;
  bool image_is_new = false;  // false: the panel repeats the last image
  Pose true_world_from_head;
};

/// `device_time` is what the device at hand measured (zero if nothing ran); only the `measured` cost source
/// looks at it.
struct JobOutcome {
  WorkCounts work;
  SimDuration device_time{0};
};

struct ShowOutcome {
  double dssim_left, dssim_right;  // NaN where not measured
};

/// The pixels behind the frame loop. Two implementations: the Vulkan renderer, and counted work without
/// pixels for pacing-only replays. Calls come in simulated-time order on one thread.
class FrameWork {
 public:
  virtual ~FrameWork() = default;
  virtual JobOutcome cast(const CastRequest& request) = 0;
  virtual JobOutcome warp(const WarpRequest& request) = 0;
  virtual ShowOutcome show(const ShowRequest& request) = 0;
};

}  // namespace brace
