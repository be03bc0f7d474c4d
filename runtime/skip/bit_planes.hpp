#pragma once

#include <cstdint>
#include <vector>

#include "runtime/raycast/volume_on_device.hpp"
#include "runtime/skip/block_grid.hpp"
#include "runtime/skip/partitioning.hpp"
#include "runtime/skip/skip_kernels.hpp"

namespace brace {

/// What one dispatch over a volume writes at most.
inline constexpr std::uint64_t slab_bytes_max = std::uint64_t{32} << 20;

/// When a block counts as occupied; kernels/block_cells.glsl.
enum class Occupancy {
  cell,   // any interpolation cell that a sample in the block can fall into overlaps a visible value
  block,  // the one interval of all these cells does: looser
  voxel   // a voxel of the block is visible (the papers): loses what interpolation makes of its neighbours
};

/// What kernels that read a volume need of it: parameters and macros for one grid.
class VolumeReader {
 public:
  VolumeReader(const gpu::Device& device, const VolumeOnDevice& volume, const BlockGrid& grid,
               Occupancy occupancy);

  const Defines& defines() const { return defines_; }
  gpu::Binding params() const { return gpu::bind(0, params_); }
  gpu::Binding volume() const { return volume_->binding(5); }

 private:
  const VolumeOnDevice* volume_;
  Defines defines_;
  gpu::Buffer params_;
};

/// A bit per partition and block, all from one pass over the volume: n / 8 bytes per block, a plane after the
/// other. The device must outlive it.
class BitPlanes {
 public:
  BitPlanes() = default;

  /// Reads the volume. Waits for the device; `progress` may be empty. Throws device_error when the planes do
  /// not fit the device.
  BitPlanes(SkipKernels& kernels, const VolumeOnDevice& volume, const BlockGrid& grid,
            const Partitioning& partitioning, Occupancy occupancy, const Progress& progress = {});

  /// Takes planes that a cache has kept: plane_bytes each, one after the other.
  BitPlanes(const gpu::Device& device, const BlockGrid& grid, int planes, std::span<const std::byte> bytes);

  static std::uint64_t bytes_for(const BlockGrid& grid, int partitions) {
    return grid.plane_bytes() * static_cast<std::uint64_t>(partitions);
  }

  int count() const { return count_; }
  std::uint64_t device_bytes() const { return buffer_.size_bytes(); }
  const gpu::Buffer& buffer() const { return buffer_; }
  const gpu::TexelBuffer& words() const { return words_; }  // R32_UINT
  const gpu::TexelBuffer& quads() const { return quads_; }  // RGBA32_UINT

 private:
  BitPlanes(const gpu::Device& device, const BlockGrid& grid, int planes);

  int count_ = 0;
  gpu::Buffer buffer_;
  gpu::TexelBuffer words_, quads_;
};

/// One plane in its own buffer, and both views of it.
struct BitPlane {
  BitPlane() = default;
  BitPlane(const gpu::Device& device, const BlockGrid& grid, std::string name);
  gpu::Buffer buffer;
  gpu::TexelBuffer words;
};

/// Records target = OR of the planes that are visible. Bytes read and written.
std::uint64_t record_union(gpu::CommandList& commands, SkipKernels& kernels, const BlockGrid& grid,
                           const BitPlanes& planes, const std::vector<bool>& visible, const BitPlane& target);

}  // namespace brace
