#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/skip/structures.hpp"

namespace brace {

/// A name for a volume's bit planes: 128 bits, hexadecimal, of the voxels, the dimensions and what the planes
/// were made with. Reads the volume once, on the device.
std::string plane_cache_key(SkipKernels& kernels, const VolumeOnDevice& volume, const BlockGrid& grid,
                            const Partitioning& partitioning, Occupancy occupancy);

/// The planes kept under a key; nothing if there are none or the file is damaged.
std::optional<std::vector<std::byte>> read_plane_cache(const std::filesystem::path& folder,
                                                       const std::string& key, std::uint64_t size_bytes);

/// Keeps planes; appears whole or not at all. A folder that cannot be written throws input_error naming it.
void write_plane_cache(const std::filesystem::path& folder, const std::string& key,
                       std::span<const std::byte> bytes);

}  // namespace brace
