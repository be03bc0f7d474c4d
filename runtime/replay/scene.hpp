#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "runtime/frame/frame_work.hpp"
#include "runtime/raycast/transfer_on_device.hpp"
#include "runtime/raycast/volume_on_device.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/replay.hpp"
#include "runtime/replay/transfer_versions.hpp"
#include "runtime/skip/skip_structure.hpp"
#include "runtime/volume/statistics.hpp"

namespace brace {

class VolumeLevels;

/// A session's volume and transfer function in device memory.
struct SceneOnDevice {
  explicit SceneOnDevice(std::shared_ptr<const VolumeOnDevice> held)
      : held_volume(std::move(held)), volume(*held_volume) {}

  std::shared_ptr<const VolumeOnDevice> held_volume;  // several scenes can share one
  const VolumeOnDevice& volume;
  TransferVersions versions;
  std::int64_t transfer_version = 0;  // that the members below stand for
  TransferTable table;
  double step_units = 0.5;
  TransferOnDevice transfer;  // with the cast stage's step baked in
  VoxelStatistics statistics;
  std::unique_ptr<SkipKernels> skip_kernels;
  PipelineStage skip_stage;                         // the session's, or what pipeline.skip = "auto" became
  std::string skip_reason;                          // why it became that; "" where the session names it
  std::unique_ptr<SkipStructure> skip;              // null for skip/none
  std::optional<gpu::CommandList> update_commands;  // made at the first update
  std::string skip_memory;  // what the structure takes and why, for the report; "" without one
  std::shared_ptr<const VolumeLevels> levels;  // null unless the cast stage asks for coarser levels

  /// Brings transfer function and structure to a version; nothing submitted may be waiting. Returns the work
  /// of the change: the bytes of the table and those that the structure reads and writes.
  JobOutcome show_transfer(const gpu::Device& device, std::int64_t version);

  /// What the skip stage's snippet binds.
  std::span<const gpu::Binding> skip_bindings() const {
    return skip ? skip->bindings() : std::span<const gpu::Binding>();
  }
  SkipMapBuffers skip_map() const { return skip ? skip->map_buffers() : SkipMapBuffers(); }
};

/// Distance between samples in the smallest voxel spacing: the cast stage's step_voxels, 0.5 if it has none.
double step_voxels_of(const Session& session);

/// Streams the volume to the device, bakes the transfer function and builds the skip stage's structure (a
/// native stage is activated for it), which refers to the volume: the scene stays where it is. Throws
/// brace::Error or Interrupted. With `volume_of` the volume is not read again: it is that scene's, which must
/// have been loaded for the same one.
std::unique_ptr<SceneOnDevice> load_scene(const gpu::Device& device, const Session& session,
                                          const ReplayOptions& options, const Headset& headset,
                                          const VolumePlacement& placement,
                                          const SceneOnDevice* volume_of = nullptr);

/// Whether two sessions put the same volume into device memory, as long as its file stays as it is.
bool same_volume(const Session& a, const Session& b);

}  // namespace brace
