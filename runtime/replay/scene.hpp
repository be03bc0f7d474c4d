#pragma once

#include <filesystem>

#include "runtime/raycast/transfer_on_device.hpp"
#include "runtime/raycast/volume_on_device.hpp"
#include "runtime/session/session.hpp"
#include "runtime/volume/statistics.hpp"

namespace brace {

/// A session's volume and transfer function in device memory.
struct SceneOnDevice {
  VolumeOnDevice volume;
  TransferTable table;
  TransferOnDevice transfer;  // with the cast stage's step baked in
  VoxelStatistics statistics;
};

/// Distance between samples in the smallest voxel spacing: the cast stage's step_voxels, 0.5 if it has none.
double step_voxels_of(const Session& session);

/// Streams the volume to the device and bakes the transfer function. Throws brace::Error.
SceneOnDevice load_scene(const gpu::Device& device, const Session& session,
                         const std::filesystem::path& data_folder);

}  // namespace brace
