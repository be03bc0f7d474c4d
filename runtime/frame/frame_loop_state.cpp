#include "runtime/frame/frame_loop_state.hpp"

#include <cmath>

#include "base/error.hpp"

namespace brace::frame_loop {

Pose predict(const PredictStage& stage, std::span<const brace_tracker_sample> readings, SimTime target) {
  brace_pose pose{};
  const brace_result result = stage.functions->predict(
      stage.self, readings.data(), static_cast<std::uint32_t>(readings.size()), to_ns(target), &pose);
  const double* q = pose.orientation_xyzw;
  const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const double reach = pose.position_m[0] + pose.position_m[1] + pose.position_m[2];
  if (result != BRACE_OK || !(std::abs(norm - 1) < 1e-6) || !std::isfinite(reach)) {
    throw device_error(
        "{} failed in predict; expected BRACE_OK and a finite unit pose; found result {}, |q|^2 = {} for t = "
        "{} ns",
        stage.name, static_cast<int>(result), norm, to_ns(target));
  }
  return sim::from_abi(pose);
}

Pose shown_pose(const DisplayImage& image, WarpPose warp_pose) {
  Pose shown = image.eye.world_from_head;
  if (warp_pose != WarpPose::none) shown.orientation = image.warp_world_from_head.orientation;
  if (warp_pose == WarpPose::rotation_and_translation) shown.position = image.warp_world_from_head.position;
  return shown;
}

void describe_image(FrameRecord& record, const DisplayImage& image, WarpPose warp_pose) {
  record.displayed_frame = image.eye.frame;
  record.render_pose_ns = image.eye.reading_ns;
  record.render_target_ns = image.eye.target_ns;
  record.render_start_ns = image.eye.start_ns;
  record.render_done_ns = image.eye.done_ns;
  record.warp_pose_ns = image.reading_ns;
  record.warp_start_ns = image.start_ns;
  record.warp_done_ns = image.done_ns;
  record.mtp_rotation_ns = record.photon_mid_ns - image.reading_ns;
  record.mtp_translation_ns =
      record.photon_mid_ns -
      (warp_pose == WarpPose::rotation_and_translation ? image.reading_ns : image.eye.reading_ns);
  record.frame_age_ns = record.vsync_ns - image.eye.reading_ns;
  record.work = image.eye.work;
}

}  // namespace brace::frame_loop
