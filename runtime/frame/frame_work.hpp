#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "base/error.hpp"
#include "base/pose.hpp"
#include "base/time.hpp"
#include "hmd_sim/pose_trace.hpp"
#include "runtime/frame/cell_cuts.hpp"
#include "runtime/metrics/frame_record.hpp"

namespace brace {

/// Slots of the ray-casting swap-chain: one in front, read by warps, and one being cast.
inline constexpr int frame_slots = 2;

/// An eye frame asked of the raycaster: both eyes, seen from one predicted head pose, into a swap-chain slot.
struct CastRequest {
  std::int64_t frame = 0;
  int slot = 0;  // 0 .. frame_slots - 1
  Pose world_from_head{};
  SimTime start{};
  double quality = 1.0;  // 0 < quality <= 1, from the control stage: fraction of the full ray count
  int cell_columns = 0, cell_rows = 0;    // of each eye: outcomes of cells are wanted; 0: of the frame alone
  std::span<const CellCuts> cuts{};       // of the left and the right eye into these cells; empty: even
  glm::dvec3 gaze = sim::straight_ahead;  // as known at `start`, in the head frame
};

/// One cell of an eye frame, from a pose of its own (ChunkedParams::own_poses). `frame` is asked for in this
/// way alone: each of its cells once, in any order, and never as a whole.
struct CellRequest {
  CastRequest frame{};  // pose and start are the cell's
  int cell = 0;         // of the left eye row by row, then of the right one
};

/// Head poses at the photons of a vsync's first and last line, in the order of the scan-out.
struct ScanPoses {
  Pose first_line, last_line;
};

/// One display image: the newest finished eye frame, re-projected to the newest pose and distorted. At most
/// one image waits for its vsync: the next warp comes only after this one was shown.
struct WarpRequest {
  std::int64_t vsync_index = 0;
  std::int64_t frame = 0;
  int slot = 0;
  Pose render_world_from_head{};
  Pose warp_world_from_head{};           // the render pose if the warp stage uses no pose
  SimTime start{};                       // when the pose is latched and the job submitted
  std::optional<ScanPoses> warp_scan{};  // where asked for (FrameLoopConfig::scan_poses) and a pose is used
};

/// A vsync with its photons: what was shown, and where the head truly is at photon time.
struct ShowRequest {
  std::int64_t vsync_index = 0;
  bool image_is_new = false;  // true: the image of the last warp; false: the panel repeats what it has
  Pose true_world_from_head{};
  std::int64_t transfer_version = 0;           // in force at photon time: what an ideal picture shows
  std::optional<ScanPoses> true_scan{};        // where asked for
  glm::dvec3 true_gaze = sim::straight_ahead;  // at photon time, in the head frame
};

/// A change of the transfer function: what is cast from now on shows this version, and the structures that
/// skip empty space must be brought to it first. Versions: TransferSchedule.
struct UpdateRequest {
  std::int64_t frame = 0;  // the first eye frame that shows it
  std::int64_t transfer_version = 0;
  SimTime start{};
};

/// A part of a cast: the rays of one cell.
struct CellOutcome {
  WorkCounts work{};
  SimDuration device_time{0};
};

/// `device_time` is what the device at hand measured (zero if nothing ran); only the `measured` cost source
/// looks at it. `cells`, where they were asked for and are known: the left eye's row by row, then the right
/// one's; valid until the next call. They sum up to the whole.
struct JobOutcome {
  WorkCounts work{};
  SimDuration device_time{0};
  std::span<const CellOutcome> cells{};
};

/// The pixels behind the frame loop. Two implementations: the Vulkan renderer, and counted work without
/// pixels for pacing-only replays. Calls come in simulated-time order on one thread. A warp may come before
/// the cast that was asked for before it has ended in simulated time; it then names the other slot, unless
/// cells are shown one by one.
class FrameWork {
 public:
  virtual ~FrameWork() = default;
  /// Called between casts, before the cast of the eye frame that it names.
  virtual JobOutcome update(const UpdateRequest& request) = 0;
  virtual JobOutcome cast(const CastRequest& request) = 0;
  /// Asked only where the schedule wants poses of cells; work that gives none need not say so.
  virtual CellOutcome cast_cell(const CellRequest&) {
    BRACE_CHECK(false);
    return {};
  }
  virtual JobOutcome warp(const WarpRequest& request) = 0;
  /// Called for every vsync from the first image on, in order. Not called before there is an image. Work
  /// without pixels has nothing to do.
  virtual void show(const ShowRequest&) {}
};

}  // namespace brace
