#include "runtime/raycast/volume_path.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/raycast/packed_layout.hpp"

namespace brace {

namespace {

/// Why the sampler path cannot take the volume; "" if it can.
std::string sampler_obstacle(const VolumeInfo& volume, const gpu::DeviceLimits& limits) {
  const int longest = *std::max_element(volume.dims.begin(), volume.dims.end());
  if (static_cast<std::uint32_t>(longest) > limits.image_3d_px_max) {
    return fmt::format("an edge of {} voxels is over the device's {} for 3D images", longest,
                       limits.image_3d_px_max);
  }
  if (volume.byte_count() > limits.allocation_bytes_max) {
    return fmt::format("{} bytes are over the {} the device gives in one allocation", volume.byte_count(),
                       limits.allocation_bytes_max);
  }
  return "";
}

/// Why the packed path cannot take the volume; "" if it can.
std::string packed_obstacle(const VolumeInfo& volume, const gpu::DeviceLimits& limits) {
  const PackedLayout layout(volume);
  if (layout.texels() > limits.texel_buffer_texels_max) {
    return fmt::format("{} packed texels are over the device's {}", layout.texels(),
                       limits.texel_buffer_texels_max);
  }
  if (layout.bytes() > limits.allocation_bytes_max) {
    return fmt::format("{} packed bytes are over the {} the device gives in one allocation", layout.bytes(),
                       limits.allocation_bytes_max);
  }
  return "";
}

/// The promise is a peak of 1.3 x the volume + 300 MB; 100 MB of these are for the program itself.
bool packed_is_too_much_memory(const VolumeInfo& volume) {
  const double spare_bytes = 200e6;
  return static_cast<double>(PackedLayout(volume).bytes()) >
         1.3 * static_cast<double>(volume.byte_count()) + spare_bytes;
}

/// What is left of automatic by limits and memory alone.
std::optional<VolumePathChoice> only_path_there_is(const VolumeInfo& volume,
                                                   const gpu::DeviceLimits& limits) {
  const std::string no_sampler = sampler_obstacle(volume, limits);
  const std::string no_packed = packed_obstacle(volume, limits);
  if (!no_sampler.empty() && !no_packed.empty()) {
    throw device_error("{}: the volume does not fit the device: as an image {}; as a texel buffer {}",
                       volume.source, no_sampler, no_packed);
  }
  if (!no_sampler.empty()) return VolumePathChoice{VolumePath::packed, "packed: " + no_sampler};
  if (!no_packed.empty()) return VolumePathChoice{VolumePath::sampler, "sampler: " + no_packed};
  if (!packed_is_too_much_memory(volume)) return std::nullopt;
  return VolumePathChoice{VolumePath::sampler,
                          fmt::format("sampler: packing would take {} MB of memory for a volume of {} MB",
                                      PackedLayout(volume).bytes() / 1000000, volume.byte_count() / 1000000)};
}

}  // namespace

const char* to_string(VolumePath path) {
  switch (path) {
    case VolumePath::automatic:
      return "auto";
    case VolumePath::sampler:
      return "sampler";
    case VolumePath::packed:
      return "packed";
  }
  return "?";
}

VolumePath parse_volume_path(const std::string& text) {
  for (const VolumePath path : {VolumePath::automatic, VolumePath::sampler, VolumePath::packed}) {
    if (text == to_string(path)) return path;
  }
  throw input_error("'{}' is not a data path; accepted: auto, sampler, packed", text);
}

std::optional<VolumePathChoice> forced_volume_path(const VolumeInfo& volume, const gpu::DeviceLimits& limits,
                                                   VolumePath wanted) {
  if (wanted == VolumePath::automatic) return only_path_there_is(volume, limits);
  const std::string obstacle =
      wanted == VolumePath::sampler ? sampler_obstacle(volume, limits) : packed_obstacle(volume, limits);
  if (!obstacle.empty())
    throw device_error("{}: data path '{}': {}", volume.source, to_string(wanted), obstacle);
  return VolumePathChoice{wanted, fmt::format("{}: asked for", to_string(wanted))};
}

VolumePathChoice usual_volume_path(const gpu::DeviceLimits& limits) {
  if (limits.is_software)
    return {VolumePath::packed,
            "packed: a software device gathers 32-bit texels faster than it filters images"};
  return {VolumePath::sampler, "sampler: the device filters 3D images in hardware"};
}

VolumePathChoice choose_volume_path(const VolumeInfo& volume, const gpu::DeviceLimits& limits,
                                    VolumePath wanted) {
  const std::optional<VolumePathChoice> forced = forced_volume_path(volume, limits, wanted);
  return forced ? *forced : usual_volume_path(limits);
}

}  // namespace brace
