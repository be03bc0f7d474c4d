#include <algorithm>

#include "runtime/skip/bit_planes.hpp"
#include "runtime/skip/kernels/build_params.h"
#include "runtime/skip/structures.hpp"

namespace brace {

namespace {

struct RangeBitsParams {
  std::uint32_t words;
};

}  // namespace

VisibleKeys::VisibleKeys(const gpu::Device& device, VoxelType type)
    : type_(type),
      buffer_(device, "visible keys below each key", (std::uint64_t{key_count(type)} + 1) * 4,
              gpu::Memory::upload),
      texels_(device, buffer_, gpu::Format::r32_uint) {}

void VisibleKeys::set(const gpu::Device& device, const Visibility& visibility) {
  const std::vector<std::uint32_t> below = visibility.visible_below(type_);
  gpu::upload_values(device, buffer_, std::span<const std::uint32_t>(below));
}

void record_occupancy(gpu::CommandList& commands, SkipKernels& kernels, const BlockGrid& grid,
                      const VolumeReader& reader, const VisibleKeys& visible, const BitPlane& target) {
  const SkipBuildSlab slab{0, grid.blocks[2]};
  commands.dispatch(kernels.get("occupancy", reader.defines()),
                    {reader.params(), reader.volume(), gpu::bind(4, visible.texels()),
                     bind_range(kernels.device(), 2, target.buffer, 0, grid.plane_bytes(), "a bit plane")},
                    gpu::push_bytes(slab), linear_groups(std::uint64_t{grid.plane_words()} * 32, 32));
  commands.barrier();
}

BlockStructure::BlockStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options,
                               const Progress& progress)
    : SkipStructure(kernels, scene, options),
      ranges_(kernels.device(), "value ranges of blocks", std::uint64_t{grid_.plane_words()} * 128,
              gpu::Memory::device),
      range_texels_(kernels.device(), ranges_, gpu::Format::r32_uint),
      visible_(kernels.device(), scene.volume.info().type),
      occupied_(kernels.device(), grid_, "occupied blocks") {
  const VolumeReader reader(device(), scene.volume, grid_, options.occupancy);
  const auto& kernel = kernels.get("block_range", reader.defines());
  const std::uint64_t slice_words = std::uint64_t{grid_.row_words()} * 32 * grid_.blocks[1];
  const auto slices_max = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(slab_bytes_max / (slice_words * 4), 1, grid_.blocks[2]));
  gpu::CommandList commands(device(), "skip block build");
  for (std::uint32_t z = 0; z < grid_.blocks[2]; z += slices_max) {
    const SkipBuildSlab slab{z, std::min(slices_max, grid_.blocks[2] - z)};
    const std::uint64_t words = slice_words * slab.slices;
    commands.reset();
    commands.dispatch(kernel,
                      {reader.params(), reader.volume(),
                       bind_range(device(), 2, ranges_, slice_words * 4 * z, words * 4, "a slice of blocks")},
                      gpu::push_bytes(slab), linear_groups(words, 64));
    commands.barrier();
    gpu::submit_and_wait(commands);
    if (progress) progress(static_cast<double>(z + slab.slices) / grid_.blocks[2]);
  }
  bind_map(BRACE_SKIP_MAP_BITS, occupied_.buffer, occupied_.words);
}

WorkCounts BlockStructure::update(gpu::CommandList& commands, const TransferTable& table) {
  visible_.set(device(), visibility(table));
  const RangeBitsParams params{grid_.plane_words()};
  commands.dispatch(kernels_->get("range_bits"),
                    {gpu::bind(1, range_texels_), gpu::bind(4, visible_.texels()),
                     bind_range(device(), 2, occupied_.buffer, 0, grid_.plane_bytes(), "a bit plane")},
                    gpu::push_bytes(params), linear_groups(params.words, 64));
  commands.barrier();
  WorkCounts work;
  work.bytes = ranges_.size_bytes() + grid_.plane_bytes();
  return work;
}

std::uint64_t BlockStructure::device_bytes() const {
  return ranges_.size_bytes() + occupied_.buffer.size_bytes();
}

DistanceMapStructure::DistanceMapStructure(SkipKernels& kernels, const SkipScene& scene,
                                           const SkipOptions& options)
    : SkipStructure(kernels, scene, options),
      info_(scene.volume.info()),
      reader_(kernels.device(), scene.volume, grid_, options.occupancy),
      visible_(kernels.device(), info_.type),
      occupied_(kernels.device(), grid_, "occupied blocks"),
      map_(kernels.device(), grid_, "distance map") {
  map_.append(1);
  bind_map(BRACE_SKIP_MAP_DISTANCES, *map_.place(0).buffer, *map_.place(0).words);
}

WorkCounts DistanceMapStructure::update(gpu::CommandList& commands, const TransferTable& table) {
  visible_.set(device(), visibility(table));
  record_occupancy(commands, *kernels_, grid_, reader_, visible_, occupied_);
  WorkCounts work;
  work.bytes =
      info_.byte_count() + record_transform(commands, *kernels_, grid_, occupied_.words, 0, map_, 0, 1);
  return work;
}

std::uint64_t DistanceMapStructure::device_bytes() const {
  return occupied_.buffer.size_bytes() + map_.device_bytes();
}

}  // namespace brace
