#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "runtime/raycast/eye_view.hpp"
#include "runtime/volume/transfer_function.hpp"
#include "runtime/volume/volume.hpp"

namespace brace {

/// The ray casting scene of the benchmarks: 256^3 uint8, 83 % of the voxels zero, a lumpy ball with a hollow
/// texture; 30 degrees of field of view, half a voxel per step, early termination at 0.99.
struct RaycastScene {
  struct Transfer {
    std::string name;  // T: nearly transparent; S: surface-like
    TransferFunction function;
  };
  std::vector<Transfer> transfers;
  VolumePlacement placement;
  EyeView eye;
  double step_voxels = 0.5;
  double termination_opacity = 0.99;
};

/// The volume to make. Its content fills the box, whatever the box's shape: a ball becomes an ellipsoid.
struct SceneBall {
  std::array<int, 3> dims = {256, 256, 256};
  double radius = 0.645;  // of the zero level, where half the box is 1
  double slope = 1.55;    // of the value towards the middle, full scale 1
};

/// The volume, made from a formula slice by slice: the same bytes everywhere.
std::unique_ptr<VolumeSource> open_scene_volume(const SceneBall& ball = {});

/// The scene's transfer function "T" or "S", empty up to `visible_above` (below 0: nowhere), its absorption
/// times `absorption_scale`.
TransferFunction scene_transfer(const std::string& name, double visible_above, double absorption_scale = 1.0);

RaycastScene make_raycast_scene(int width_px = 512, int height_px = 512);

}  // namespace brace
