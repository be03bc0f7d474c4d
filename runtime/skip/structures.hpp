#pragma once

#include "runtime/skip/distance_maps.hpp"
#include "runtime/skip/merge.hpp"
#include "runtime/skip/skip_structure.hpp"

namespace brace {

// The structures behind make_skip_structure.

/// Which values a transfer function shows, for kernels that ask by key. Sets host-visible memory at once.
class VisibleKeys {
 public:
  VisibleKeys(const gpu::Device& device, VoxelType type);
  void set(const gpu::Device& device, const Visibility& visibility);
  const gpu::TexelBuffer& texels() const { return texels_; }

 private:
  VoxelType type_;
  gpu::Buffer buffer_;
  gpu::TexelBuffer texels_;
};

/// Records a bit per block from the volume itself.
void record_occupancy(gpu::CommandList& commands, SkipKernels& kernels, const BlockGrid& grid,
                      const VolumeReader& reader, const VisibleKeys& visible, const BitPlane& target);

/// Smallest and largest value per block; at a change a bit per block.
class BlockStructure final : public SkipStructure {
 public:
  BlockStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options,
                 const Progress& progress);
  WorkCounts update(gpu::CommandList& commands, const TransferTable& table) override;
  std::uint64_t device_bytes() const override;

 private:
  gpu::Buffer ranges_;
  gpu::TexelBuffer range_texels_;
  VisibleKeys visible_;
  BitPlane occupied_;
};

/// Nothing kept per volume; at a change occupancy from the volume and the transform.
class DistanceMapStructure final : public SkipStructure {
 public:
  DistanceMapStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options);
  WorkCounts update(gpu::CommandList& commands, const TransferTable& table) override;
  std::uint64_t device_bytes() const override;

 private:
  VolumeInfo info_;
  VolumeReader reader_;
  VisibleKeys visible_;
  BitPlane occupied_;
  DistanceMaps map_;
};

/// A bit per partition and block; at a change their union and the transform.
class BitmaskStructure final : public SkipStructure {
 public:
  BitmaskStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options,
                   const Progress& progress);
  WorkCounts update(gpu::CommandList& commands, const TransferTable& table) override;
  std::uint64_t device_bytes() const override;

 private:
  Partitioning partitioning_;
  BitPlanes planes_;
  BitPlane occupied_;
  DistanceMaps map_;
};

/// A bit-field per node; at a change only the transfer function's bits.
class OctreeStructure final : public SkipStructure {
 public:
  OctreeStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options,
                  const Progress& progress);
  WorkCounts update(gpu::CommandList& commands, const TransferTable& table) override;
  std::uint64_t device_bytes() const override;

 private:
  void build(const BitPlanes& planes, std::uint32_t words);

  Partitioning partitioning_;
  gpu::Buffer nodes_;
  gpu::TexelBuffer node_texels_;
};

/// Maps that together give the minimum of any run of leaf maps.
class RangeCover {
 public:
  RangeCover() = default;
  RangeCover(RangeMinima kind, int leaves) : kind_(kind), leaves_(leaves) {}

  int maps() const;  // leaves included; leaf p is map p
  /// A map as the minimum of two others made before it; for maps leaves … maps() - 1, in this order.
  struct Pair {
    int map, a, b;
  };
  std::vector<Pair> pairs() const;
  /// Appends the maps whose minimum is that of the run.
  void cover(PartitionRun run, std::vector<int>& maps) const;

 private:
  RangeMinima kind_ = RangeMinima::none;
  int leaves_ = 0;
};

/// A distance map per partition (PDMs) and D' as the minimum of those visible.
class PartitionedStructure final : public SkipStructure {
 public:
  PartitionedStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options,
                       const Progress& progress);
  WorkCounts update(gpu::CommandList& commands, const TransferTable& table) override;
  std::uint64_t device_bytes() const override;

 private:
  void build_maps(const Progress& progress);
  std::uint64_t make_missing(gpu::CommandList& commands, const std::vector<bool>& visible);

  Partitioning partitioning_;
  RangeCover cover_;
  BitPlanes planes_;  // kept by a lazy structure only
  DistanceMaps maps_, merged_;
  std::vector<int> map_of_;  // lazy: by partition, -1 until made
};

/// Planes from the cache if they are there, else from the volume (and into the cache).
BitPlanes cached_planes(SkipKernels& kernels, const SkipScene& scene, const BlockGrid& grid,
                        const Partitioning& partitioning, const SkipOptions& options,
                        const Progress& progress);

}  // namespace brace
