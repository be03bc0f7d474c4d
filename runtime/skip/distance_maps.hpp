#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/gpu/commands.hpp"
#include "runtime/skip/bit_planes.hpp"
#include "runtime/skip/block_grid.hpp"
#include "runtime/skip/skip_kernels.hpp"

namespace brace {

/// Maps of Chebyshev distances in blocks to the nearest occupied one, 0 ... 127 (127: that far or farther), a
/// byte per block, in pieces of device memory that grow as maps are added. The device must outlive it.
class DistanceMaps {
 public:
  DistanceMaps() = default;
  DistanceMaps(const gpu::Device& device, const BlockGrid& grid, std::string name);

  /// Appends `count` maps with undefined contents, in pieces as large as the device allows. Returns the index
  /// of the first.
  int append(int count);

  int count() const { return count_; }
  std::uint64_t device_bytes() const { return static_cast<std::uint64_t>(count_) * map_bytes_; }

  struct Place {
    const gpu::Buffer* buffer = nullptr;
    const gpu::TexelBuffer* quads = nullptr;  // RGBA32_UINT, of the whole buffer
    const gpu::TexelBuffer* words = nullptr;  // R32_UINT, four blocks each
    std::uint32_t index = 0;                  // of the map in the buffer
    std::uint32_t piece = 0;
    std::uint32_t maps_after = 0;  // in the same buffer, this one included
  };
  Place place(int map) const;

 private:
  struct Piece {
    int first = 0, count = 0;
    gpu::Buffer buffer;
    gpu::TexelBuffer quads, words;
  };

  const gpu::Device* device_ = nullptr;
  std::uint64_t map_bytes_ = 0;
  std::string name_;
  int count_ = 0;
  std::vector<Piece> pieces_;
};

/// Records the exact Chebyshev transform of planes first_plane ... first_plane + count - 1 into maps
/// first_map …. O(blocks): x from the bits, then sweeps along y and z with minima of three and nine
/// neighbours. Bytes read and written.
std::uint64_t record_transform(gpu::CommandList& commands, SkipKernels& kernels, const BlockGrid& grid,
                               const gpu::TexelBuffer& planes, int first_plane, const DistanceMaps& maps,
                               int first_map, int count);

/// Records target = smallest of `sources` (Eq. 1), 16 of those that lie in one piece of memory in a pass; of
/// none: all 127. Bytes read and written.
std::uint64_t record_minimum(gpu::CommandList& commands, SkipKernels& kernels, const BlockGrid& grid,
                             const DistanceMaps& maps, std::span<const int> sources,
                             const DistanceMaps& target, int target_map);

}  // namespace brace
