#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "runtime/gpu/commands.hpp"
#include "runtime/raycast/volume_on_device.hpp"
#include "runtime/skip/skip_structure.hpp"

namespace brace::bench {

/// The rival: occupancy, transform and merge with uint8 textures, as published.
class PublishedMaps {
 public:
  /// The volume must lie on the sampler path; blocks of 4 voxels.
  PublishedMaps(const gpu::Device& device, const VolumeOnDevice& volume,
                const std::filesystem::path& kernels_folder);

  /// Device time of occupancy and transform, ms.
  double recompute_ms(const TransferTable& table);

  /// Fills `count` maps with noise for the merge; replaces what there was.
  void make_maps(int count);

  /// Device time of merging the first `count` maps, six in a pass, ms.
  double merge_ms(int count);

  const BlockGrid& grid() const { return grid_; }

 private:
  gpu::Binding sampled(std::uint32_t slot, const gpu::Image3D& image) const {
    return gpu::bind(slot, image, sampler_);
  }

  const gpu::Device* device_;
  const VolumeOnDevice* volume_;
  BlockGrid grid_;
  SkipKernels kernels_;
  gpu::Sampler sampler_;
  gpu::Image2D transfer_;
  std::array<gpu::Image3D, 2> flip_;
  std::vector<gpu::Image3D> maps_;
};

}  // namespace brace::bench
