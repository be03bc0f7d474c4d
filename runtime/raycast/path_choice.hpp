#pragma once

#include <filesystem>
#include <string>

#include "runtime/gpu/measurements.hpp"
#include "runtime/raycast/volume_path.hpp"

namespace brace {

/// The path of a volume on a device. Where it is not forced (forced_volume_path), both paths cast a small
/// volume of the same kind of voxels with cast/dvr, and the faster one is taken: once per device, driver,
/// width of the voxels and text of the kernels, as long as `measurements` keeps it; a quarter of a second on
/// two cores. Close times go to the usual path, so that equal runs take the same. A measurement that fails
/// leaves the usual path, too, and the reason says so. `data_folder`: share/brace.
VolumePathChoice choose_volume_path(const gpu::Device& device, const VolumeInfo& volume, VolumePath wanted,
                                    const std::filesystem::path& data_folder,
                                    gpu::Measurements& measurements);

}  // namespace brace
