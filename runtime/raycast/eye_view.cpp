#include "runtime/raycast/eye_view.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace brace {

namespace {

glm::dvec3 dims_of(const VolumeInfo& volume) {
  return {volume.dims[0], volume.dims[1], volume.dims[2]};
}

glm::dvec3 voxels_per_unit(const VolumeInfo& volume) {
  const double unit = voxel_length(volume);
  return {unit / volume.spacing[0], unit / volume.spacing[1], unit / volume.spacing[2]};
}

/// A direction of the eye frame along the volume's metric axes.
glm::dvec3 volume_from_eye(const EyeView& eye, const VolumePlacement& placement,
                           const glm::dvec3& direction) {
  return glm::conjugate(placement.world_from_volume.orientation) *
         (eye.world_from_eye.orientation * direction);
}

void set(float (&to)[4], const glm::dvec3& xyz, double w) {
  for (int axis = 0; axis < 3; ++axis)
    to[axis] = static_cast<float>(xyz[axis]);
  to[3] = static_cast<float>(w);
}

bool is_finite(const Pose& pose) {
  const glm::dquat& q = pose.orientation;
  const glm::dvec3& p = pose.position;
  return std::isfinite(q.w + q.x + q.y + q.z) && std::isfinite(p.x + p.y + p.z);
}

void check(const EyeView& eye, const VolumePlacement& placement) {
  if (eye.width_px < 1 || eye.height_px < 1) {
    throw input_error("the eye image is {} x {} pixels; both must be at least 1", eye.width_px,
                      eye.height_px);
  }
  const bool opens = eye.tan_left < eye.tan_right && eye.tan_bottom < eye.tan_top;
  if (!opens || !std::isfinite(eye.tan_right - eye.tan_left) ||
      !std::isfinite(eye.tan_top - eye.tan_bottom)) {
    throw input_error(
        "the field of view has the tangents left {} right {} bottom {} top {}; left < right and bottom < top "
        "must hold",
        eye.tan_left, eye.tan_right, eye.tan_bottom, eye.tan_top);
  }
  if (!is_finite(eye.world_from_eye)) throw input_error("the eye's pose has numbers that are not finite");
  if (!is_finite(placement.world_from_volume))
    throw input_error("the volume's pose has numbers that are not finite");
  if (!std::isfinite(placement.size_m) || placement.size_m <= 0.0) {
    throw input_error("the volume's longest edge is {} m; it must be above 0", placement.size_m);
  }
}

}  // namespace

double metres_per_unit(const VolumeInfo& volume, const VolumePlacement& placement) {
  const auto box = box_size(volume);
  return voxel_length(volume) * placement.size_m / *std::max_element(box.begin(), box.end());
}

glm::dvec3 voxel_from_world(const VolumeInfo& volume, const VolumePlacement& placement,
                            const glm::dvec3& point_m) {
  const glm::dvec3 in_volume = transform_point(inverse(placement.world_from_volume), point_m);
  return in_volume / metres_per_unit(volume, placement) * voxels_per_unit(volume) + 0.5 * dims_of(volume);
}

BraceEyeParams eye_params(const EyeView& eye, const VolumeInfo& volume, const VolumePlacement& placement) {
  check(eye, placement);
  BraceEyeParams params{};
  const double width = eye.tan_right - eye.tan_left;
  const double height = eye.tan_top - eye.tan_bottom;
  set(params.eye, voxel_from_world(volume, placement, eye.world_from_eye.position),
      metres_per_unit(volume, placement));
  set(params.ray_base, volume_from_eye(eye, placement, {eye.tan_left, eye.tan_top, -1.0}), 0.0);
  set(params.ray_dx, volume_from_eye(eye, placement, {width / eye.width_px, 0.0, 0.0}), 0.0);
  set(params.ray_dy, volume_from_eye(eye, placement, {0.0, -height / eye.height_px, 0.0}), 0.0);
  set(params.voxels_per_unit, voxels_per_unit(volume), 1.0);
  set(params.volume_dims, dims_of(volume), 0.0);
  const auto across = static_cast<std::uint32_t>(eye.width_px);
  const auto down = static_cast<std::uint32_t>(eye.height_px);
  const std::uint32_t grid[4] = {across, down, across, down};
  std::copy(std::begin(grid), std::end(grid), std::begin(params.grid));
  return params;
}

}  // namespace brace
