#include <algorithm>

#include "runtime/skip/kernels/build_params.h"
#include "runtime/skip/structures.hpp"

namespace brace {

namespace {

constexpr std::uint64_t slab_bytes_max = std::uint64_t{32} << 20;

gpu::Buffer visible_buffer(const gpu::Device& device, VoxelType type) {
  return gpu::Buffer(device, "visible keys below each key", (std::uint64_t{key_count(type)} + 1) * 4,
                     gpu::Memory::upload);
}

void write_visible(const gpu::Device& device, const gpu::Buffer& buffer, const Visibility& visibility,
                   VoxelType type) {
  const std::vector<std::uint32_t> below = visibility.visible_below(type);
  gpu::upload_values(device, buffer, std::span<const std::uint32_t>(below));
}

struct RangeBitsParams {
  std::uint32_t words;
};

}  // namespace

BlockStructure::BlockStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options,
                               const Progress& progress)
    : SkipStructure(kernels, scene, options),
      type_(scene.volume.info().type),
      ranges_(kernels.device(), "value ranges of blocks", std::uint64_t{grid_.plane_words()} * 128,
              gpu::Memory::device),
      visible_below_(visible_buffer(kernels.device(), type_)),
      range_texels_(kernels.device(), ranges_, gpu::Format::r32_uint),
      visible_texels_(kernels.device(), visible_below_, gpu::Format::r32_uint),
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
  bind_map(occupied_.words);
}

WorkCounts BlockStructure::update(gpu::CommandList& commands, const TransferTable& table) {
  write_visible(device(), visible_below_, visibility(table), type_);
  const RangeBitsParams params{grid_.plane_words()};
  commands.dispatch(kernels_->get("range_bits"),
                    {gpu::bind(1, range_texels_), gpu::bind(4, visible_texels_),
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
      visible_below_(visible_buffer(kernels.device(), info_.type)),
      visible_texels_(kernels.device(), visible_below_, gpu::Format::r32_uint),
      occupied_(kernels.device(), grid_, "occupied blocks"),
      map_(kernels.device(), grid_, "distance map") {
  map_.append(1);
  bind_map(*map_.place(0).words);
}

WorkCounts DistanceMapStructure::update(gpu::CommandList& commands, const TransferTable& table) {
  write_visible(device(), visible_below_, visibility(table), info_.type);
  const SkipBuildSlab slab{0, grid_.blocks[2]};
  commands.dispatch(kernels_->get("occupancy", reader_.defines()),
                    {reader_.params(), reader_.volume(), gpu::bind(4, visible_texels_),
                     bind_range(device(), 2, occupied_.buffer, 0, grid_.plane_bytes(), "a bit plane")},
                    gpu::push_bytes(slab), linear_groups(std::uint64_t{grid_.plane_words()} * 32, 32));
  commands.barrier();
  WorkCounts work;
  work.bytes =
      info_.byte_count() + record_transform(commands, *kernels_, grid_, occupied_.words, 0, map_, 0, 1);
  return work;
}

std::uint64_t DistanceMapStructure::device_bytes() const {
  return occupied_.buffer.size_bytes() + map_.device_bytes();
}

}  // namespace brace
