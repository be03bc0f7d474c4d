#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "runtime/volume/stored_volume.hpp"

namespace brace {

/// Reverses the bytes of each voxel in place.
void swap_bytes(std::span<std::byte> voxels, std::size_t bytes_per_voxel);

/// The first voxel that cannot be kept exactly.
struct InexactVoxel {
  std::size_t index = 0;
  double value = 0;
};

/// Voxels of `stored` type (host byte order) to stored.info.type, scale applied in double and rounded once.
/// Returns the first voxel that the type cannot hold exactly, for a conversion that has to be exact (no
/// scale).
std::optional<InexactVoxel> convert_voxels(const StoredVolume& stored, std::span<const std::byte> from,
                                           std::span<std::byte> to);

}  // namespace brace
