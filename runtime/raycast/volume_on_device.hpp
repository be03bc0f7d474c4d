#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "plugins/abi/glsl/brace/eye_params.h"
#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/memory.hpp"
#include "runtime/raycast/volume_path.hpp"
#include "runtime/volume/statistics.hpp"
#include "runtime/volume/volume.hpp"

namespace brace {

/// A volume in device memory. The device must outlive it.
class VolumeOnDevice {
 public:
  VolumeOnDevice() = default;

  /// Streams `source` slab by slab; there is never a whole copy in host memory beside the device's. `scan`,
  /// if given, sees every voxel on the way. Throws brace::Error of the source, or device_error when the
  /// device has no room.
  VolumeOnDevice(const gpu::Device& device, VolumeSource& source, VolumePathChoice choice,
                 VoxelScan* scan = nullptr, const Progress& progress = {});

  /// The same on a path that is named, or by the device's kind without measuring (choose_volume_path).
  VolumeOnDevice(const gpu::Device& device, VolumeSource& source, VolumePath wanted = VolumePath::automatic,
                 VoxelScan* scan = nullptr, const Progress& progress = {})
      : VolumeOnDevice(device, source, choose_volume_path(source.info(), device.limits(), wanted), scan,
                       progress) {}

  const VolumeInfo& info() const { return info_; }
  VolumePath path() const { return choice_.path; }
  const std::string& path_reason() const { return choice_.reason; }
  const std::string& path_figures() const { return choice_.figures; }
  std::uint64_t device_bytes() const { return device_bytes_; }

  /// The macros of brace/volume.glsl that choose the access.
  std::vector<std::pair<std::string, std::string>> defines() const;

  /// The volume as a kernel binds it; valid as long as this object stays where it is.
  gpu::Binding binding(std::uint32_t slot) const;

  /// Fills value and texel_grid; transfer must be filled already.
  void describe(BraceEyeParams& params) const;

 private:
  void stream_to_image(const gpu::Device& device, VolumeSource& source, VoxelScan* scan,
                       const Progress& progress);
  void stream_packed(const gpu::Device& device, VolumeSource& source, VoxelScan* scan,
                     const Progress& progress);

  VolumeInfo info_;
  VolumePathChoice choice_;
  std::uint64_t device_bytes_ = 0;
  gpu::Image3D image_;
  gpu::Sampler sampler_;
  gpu::Buffer buffer_;
  gpu::TexelBuffer texels_;
};

}  // namespace brace
