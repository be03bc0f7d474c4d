#pragma once

#include <optional>
#include <string>

#include "runtime/gpu/device.hpp"
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
  std::string reason;                     // one line for the report, the same for every run on a machine
  std::string figures = {};               // of the measurement and when it was; "" without one
};

/// The path that is asked for, or for automatic the only one that limits and memory (peak at most 1.3 x the
/// volume + 300 MB) leave; nullopt where both of them work. Asking for a path that the device cannot give, or
/// for a volume that fits neither, throws device_error saying which limit is in the way.
std::optional<VolumePathChoice> forced_volume_path(const VolumeInfo& volume, const gpu::DeviceLimits& limits,
                                                   VolumePath wanted);

/// What is usual where both work and nothing has been measured: packed on a software device, else the
/// sampler.
VolumePathChoice usual_volume_path(const gpu::DeviceLimits& limits);

/// One after the other of the two above. path_choice.hpp measures instead of taking what is usual.
VolumePathChoice choose_volume_path(const VolumeInfo& volume, const gpu::DeviceLimits& limits,
                                    VolumePath wanted = VolumePath::automatic);

}  // namespace brace
