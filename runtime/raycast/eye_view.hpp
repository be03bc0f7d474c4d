#pragma once

#include <glm/vec3.hpp>

#include "base/pose.hpp"
#include "plugins/abi/glsl/brace/eye_params.h"
#include "runtime/volume/volume.hpp"

namespace brace {

// Conventions. Voxel (i, j, k) of a volume with dims (nx, ny, nz) is a cell: the box is [0, dims] in voxel
// coordinates, a voxel's value stands at (i, j, k) + 0.5, between voxel centres values are trilinear, beyond
// the outermost centres they are those of the edge. In the world the box is centred on the volume's pose, its
// axes along the pose's, its edges dims * spacing scaled so that the longest is size_m.

/// One eye: where it is and what it sees through its image.
struct EyeView {
  Pose world_from_eye;  // eye frame: +X right, +Y up, -Z forward
  /// Signed tangents of the half angles at the image's edges (not at pixel centres); left < right, bottom <
  /// top.
  double tan_left = -1.0, tan_right = 1.0, tan_bottom = -1.0, tan_top = 1.0;
  int width_px = 0;  // rows run top to bottom
  int height_px = 0;
};

/// Where the volume is.
struct VolumePlacement {
  Pose world_from_volume;  // of the box's centre; the volume frame's axes are the voxel axes
  double size_m = 1.0;     // longest edge of the box
};

/// Length in the world of the smallest voxel spacing: what steps, absorption and ray lengths are measured in.
double metres_per_unit(const VolumeInfo& volume, const VolumePlacement& placement);

/// Voxel coordinates of a point given in the world, metres.
glm::dvec3 voxel_from_world(const VolumeInfo& volume, const VolumePlacement& placement,
                            const glm::dvec3& point_m);

/// The eye's part of the kernels' parameters: eye, ray_*, voxels_per_unit, volume_dims and grid (one ray per
/// pixel). Throws input_error when the eye, the image or the placement is not usable (not finite, empty).
BraceEyeParams eye_params(const EyeView& eye, const VolumeInfo& volume, const VolumePlacement& placement);

}  // namespace brace
