#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace brace {

/// Counted work of one job: machine-free, the same on every device for the same session.
struct WorkCounts {
  std::uint64_t rays = 0;             // rays that entered the volume
  std::uint64_t samples = 0;          // volume samples taken
  std::uint64_t skip_steps = 0;       // look-ups of a skipping structure
  std::uint64_t shading_fetches = 0;  // additional volume fetches for gradients and shading
  std::uint64_t texels = 0;           // pixels written by a warp or distortion pass
  std::uint64_t bytes = 0;            // bytes moved by transfers and updates

  bool operator==(const WorkCounts&) const = default;
  WorkCounts& operator+=(const WorkCounts& other) {
    rays += other.rays;
    samples += other.samples;
    skip_steps += other.skip_steps;
    shading_fetches += other.shading_fetches;
    texels += other.texels;
    bytes += other.bytes;
    return *this;
  }
};

/// Of what the panels show at a vsync against ideal pictures: the members of FrameRecord of these names.
struct PanelErrors {
  double dssim_left = std::numeric_limits<double>::quiet_NaN();
  double dssim_right = std::numeric_limits<double>::quiet_NaN();
  double weighted_rmse_left = std::numeric_limits<double>::quiet_NaN();
  double weighted_rmse_right = std::numeric_limits<double>::quiet_NaN();
};

/// What happened at one vsync. One record travels from prediction to report; metrics are pure functions of
/// records. All times are simulated nanoseconds; -1 where there is none yet.
struct FrameRecord {
  std::int64_t vsync_index = 0;
  std::int64_t vsync_ns = 0;
  std::int64_t displayed_frame = -1;  // index of the eye frame seen in this period; -1 before the first
  bool missed = false;                // nothing new was latched at this vsync
  std::int32_t stale_run = 0;         // consecutive misses up to and with this one
  std::int64_t render_pose_ns = -1;   // time of the tracker reading the eye frame was rendered with
  std::int64_t render_start_ns = -1;  // first work on the GPU
  std::int64_t render_done_ns = -1;
  std::int64_t warp_pose_ns = -1;  // time of the tracker reading of the image shown; render's without a warp
  std::int64_t warp_start_ns = -1;
  std::int64_t warp_done_ns = -1;
  std::int64_t photon_first_row_ns = -1;
  std::int64_t photon_mid_ns = -1;
  std::int64_t photon_last_row_ns = -1;
  std::int64_t mtp_rotation_ns = -1;     // photon_mid - pose that the rotation shown comes from
  std::int64_t mtp_translation_ns = -1;  // photon_mid - pose that the translation shown comes from
  std::int64_t frame_age_ns = -1;        // vsync - render pose time
  double angular_error_rad = std::numeric_limits<double>::quiet_NaN();  // shown against true at photon_mid
  double position_error_m = std::numeric_limits<double>::quiet_NaN();
  double dssim_left = std::numeric_limits<double>::quiet_NaN();
  double dssim_right = std::numeric_limits<double>::quiet_NaN();
  WorkCounts work;                     // of the eye frame shown
  std::int64_t render_target_ns = -1;  // photon time that the eye frame's pose was predicted for
  bool pose_valid = true;              // false: the trace has a gap at photon_mid; the errors are NaN
  /// Rotation vector from the true to the shown orientation, head axes (pitch, yaw, roll); its length is
  /// angular_error_rad.
  std::array<double, 3> angular_error_vector_rad{std::numeric_limits<double>::quiet_NaN(),
                                                 std::numeric_limits<double>::quiet_NaN(),
                                                 std::numeric_limits<double>::quiet_NaN()};
  /// Where the eyes truly look at photon_mid, as tangents right and up in the head frame; and the angle from
  /// there to the gaze that was known when the eye frame was started. NaN in runs without gaze.
  double gaze_x = std::numeric_limits<double>::quiet_NaN();
  double gaze_y = std::numeric_limits<double>::quiet_NaN();
  double gaze_error_rad = std::numeric_limits<double>::quiet_NaN();
  /// RMS error of the pixels by what the eye resolves there with the true gaze (straight ahead without gaze),
  /// 0 .. 1; measured with dssim.
  double weighted_rmse_left = std::numeric_limits<double>::quiet_NaN();
  double weighted_rmse_right = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace brace
