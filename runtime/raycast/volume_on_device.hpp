#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "plugins/abi/glsl/brace/eye_params.h"
#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/memory.hpp"
#include "runtime/volume/statistics.hpp"
#include "runtime/volume/volume.hpp"

namespace brace {

/// How the voxels lie in device memory. The pictures agree within rounding.
enum class VolumePath {
  automatic,
  sampler,  // 3D image, filtered by the device: 1 x the volume's memory; what GPUs like
  packed    // texel buffer with an apron of edge voxels, filtered in the kernel: 4 x (8 bit), 2 x (16 bit),
            // 1 x (float) the memory; what lavapipe likes, as it gathers 32-bit texels only
};

const char* to_string(VolumePath path);

/// "auto", "sampler" or "packed"; throws input_error otherwise.
VolumePath parse_volume_path(const std::string& text);

struct VolumePathChoice {
  VolumePath path = VolumePath::sampler;  // never automatic
  std::string reason;                     // one line for the report
};

/// Which path a volume takes on a device. Automatic: packed on a software device as long as its limits and
/// the memory rule (peak at most 1.3 x the volume + 300 MB) allow it, sampler otherwise. Asking for a path
/// that the device cannot give throws device_error saying which limit is in the way.
VolumePathChoice choose_volume_path(const VolumeInfo& volume, const gpu::DeviceLimits& limits,
                                    VolumePath wanted = VolumePath::automatic);

/// A volume in device memory. The device must outlive it.
class VolumeOnDevice {
 public:
  VolumeOnDevice() = default;

  /// Streams `source` slab by slab; there is never a whole copy in host memory beside the device's. `scan`,
  /// if given, sees every voxel on the way. Throws brace::Error of the source, or device_error when the
  /// device has no room.
  VolumeOnDevice(const gpu::Device& device, VolumeSource& source, VolumePath wanted = VolumePath::automatic,
                 VoxelScan* scan = nullptr, const Progress& progress = {});

  const VolumeInfo& info() const { return info_; }
  VolumePath path() const { return choice_.path; }
  const std::string& path_reason() const { return choice_.reason; }
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
