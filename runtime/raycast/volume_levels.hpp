#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/memory.hpp"
#include "runtime/volume/volume.hpp"

namespace brace {

/// How many levels coarser than the volume itself it has: each halves every edge (rounding down) as long as
/// none falls below 4 voxels; at most 8.
int coarser_levels(const VolumeInfo& volume);

/// The edges of a level; 0 is the volume's own.
std::array<int, 3> level_dims(const VolumeInfo& volume, int level);

/// Levels of a volume, coarser and coarser, slice by slice as the volume comes in: means over boxes, in
/// double and from the unrounded means of the level below. Where an edge is odd, boxes have parts of voxels.
class LevelBuilder {
 public:
  /// `slice`: called with the values of each finished slice of a level from 1 up, x fastest, slices in order.
  using Slice = std::function<void(int level, int z, std::span<const double> values)>;
  LevelBuilder(const VolumeInfo& volume, Slice slice);

  /// Values of the volume's next slice.
  void add(std::span<const double> values) { add(0, values); }

 private:
  struct Level {
    std::array<int, 3> dims{};
    int slices_in = 0;               // of the level below
    int slices_out = 0;              // finished
    std::vector<double> open, next;  // sums of the slice being made and of the one after it
  };
  void add(int level, std::span<const double> values);

  Slice slice_;
  std::vector<Level> levels_;  // [0] is the volume
};

/// The levels above 0 in device memory, packed as the packed path packs them and rounded to the voxels' type,
/// whatever path the volume takes: brace/levels.glsl. The device must outlive it.
class VolumeLevels {
 public:
  /// Reads `source` once, slice by slice. Throws brace::Error of the source, or device_error when the device
  /// has no room, naming the sizes.
  VolumeLevels(const gpu::Device& device, VolumeSource& source);

  int count() const { return count_; }
  std::uint64_t device_bytes() const { return voxels_.size_bytes() + table_.size_bytes(); }
  /// "3 coarser levels of 12345 bytes: 32 x 32 x 32, …", for the report.
  std::string summary() const;

  /// The macros of brace/levels.glsl that choose the access.
  std::vector<std::pair<std::string, std::string>> defines() const;
  std::span<const gpu::Binding> bindings() const { return bindings_; }

 private:
  VolumeInfo info_;
  int count_ = 0;
  gpu::Buffer voxels_, table_;
  gpu::TexelBuffer texels_;
  std::array<gpu::Binding, 2> bindings_;
};

}  // namespace brace
