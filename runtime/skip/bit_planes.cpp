#include "runtime/skip/bit_planes.hpp"

#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "runtime/skip/kernels/build_params.h"
#include "runtime/skip/merge.hpp"

namespace brace {

namespace {

struct PlanesParams {
  std::uint32_t groups, first_group, mask_words, first_plane, plane_count, plane_stride;
};

std::uint32_t mask_words_for(int partitions) {
  // 1, 2, 4 or 8: masks.comp adds words in these steps.
  std::uint32_t words = 1;
  while (words * 32 < static_cast<std::uint32_t>(partitions))
    words *= 2;
  return words;
}

gpu::Buffer partition_table(const gpu::Device& device, const Partitioning& partitioning) {
  std::vector<std::uint32_t> of(key_count(partitioning.type));
  for (int p = 0; p < partitioning.count(); ++p) {
    const auto i = static_cast<std::size_t>(p);
    std::fill(of.begin() + partitioning.first_key[i], of.begin() + partitioning.first_key[i + 1],
              static_cast<std::uint32_t>(p));
  }
  gpu::Buffer buffer(device, "partition of each key", of.size() * 4, gpu::Memory::device);
  gpu::upload_values(device, buffer, std::span<const std::uint32_t>(of));
  return buffer;
}

/// Kernel by kernel over a slab of blocks: masks, then their bits to the planes.
class PlaneBuilder {
 public:
  PlaneBuilder(SkipKernels& kernels, const VolumeOnDevice& volume, const BlockGrid& grid,
               const Partitioning& partitioning, Occupancy occupancy, const gpu::Buffer& planes)
      : kernels_(kernels),
        device_(kernels.device()),
        grid_(grid),
        planes_(planes),
        count_(static_cast<std::uint32_t>(partitioning.count())),
        words_(mask_words_for(partitioning.count())),
        reader_(device_, volume, grid, occupancy),
        table_(partition_table(device_, partitioning)),
        table_texels_(device_, table_, gpu::Format::r32_uint) {
    const std::uint64_t slice_bytes = std::uint64_t{grid.row_words()} * 32 * grid.blocks[1] * words_ * 4;
    slices_max_ = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(slab_bytes_max / slice_bytes, 1, grid.blocks[2]));
    masks_ =
        gpu::Buffer(device_, "masks of a slab of blocks", slice_bytes * slices_max_, gpu::Memory::device);
  }

  void build(const Progress& progress) {
    Defines defines = reader_.defines();
    defines.emplace_back("BRACE_MASK_WORDS", std::to_string(words_));
    const auto& masks = kernels_.get("masks", defines);
    gpu::CommandList commands(device_, "skip build");
    for (std::uint32_t z = 0; z < grid_.blocks[2]; z += slices_max_) {
      const SkipBuildSlab slab{z, std::min(slices_max_, grid_.blocks[2] - z)};
      const std::uint32_t groups = grid_.row_words() * grid_.blocks[1] * slab.slices;
      commands.reset();
      commands.dispatch(
          masks, {reader_.params(), gpu::bind(1, table_texels_), gpu::bind(2, masks_), reader_.volume()},
          gpu::push_bytes(slab), linear_groups(std::uint64_t{groups} * 32, 64));
      commands.barrier();
      spread(commands, groups, grid_.row_words() * grid_.blocks[1] * z);
      commands.barrier();
      gpu::submit_and_wait(commands);
      if (progress) progress(static_cast<double>(z + slab.slices) / grid_.blocks[2]);
    }
  }

 private:
  void spread(gpu::CommandList& commands, std::uint32_t groups, std::uint32_t first_group) {
    const auto& planes = kernels_.get("planes");
    const std::uint64_t stride = grid_.plane_bytes();
    const auto bound_max = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(device_.limits().storage_buffer_bytes_max / stride, 1, 32));
    for (std::uint32_t p = 0; p < count_;) {
      const std::uint32_t bound = std::min({bound_max, 32 - p % 32, count_ - p});
      const PlanesParams params{groups, first_group, words_,
                                p,      bound,       static_cast<std::uint32_t>(stride / 4)};
      commands.dispatch(planes,
                        {gpu::bind(1, masks_), bind_range(device_, 2, planes_, p * stride, bound * stride,
                                                          "a bit plane of the blocks")},
                        gpu::push_bytes(params), linear_groups(std::uint64_t{groups} * 32, 32));
      p += bound;
    }
  }

  SkipKernels& kernels_;
  const gpu::Device& device_;
  const BlockGrid& grid_;
  const gpu::Buffer& planes_;
  std::uint32_t count_, words_, slices_max_ = 1;
  VolumeReader reader_;
  gpu::Buffer table_;
  gpu::TexelBuffer table_texels_;
  gpu::Buffer masks_;
};

}  // namespace

VolumeReader::VolumeReader(const gpu::Device& device, const VolumeOnDevice& volume, const BlockGrid& grid,
                           Occupancy occupancy)
    : volume_(&volume),
      defines_(volume.defines()),
      params_(device, "skip build parameters", sizeof(SkipBuildParams), gpu::Memory::upload) {
  defines_.emplace_back("BRACE_OCCUPANCY", std::to_string(static_cast<int>(occupancy)));
  if (volume.info().type == VoxelType::float32) defines_.emplace_back("BRACE_SKIP_FLOAT", "1");
  BraceEyeParams eye{};
  volume.describe(eye);
  SkipBuildParams params{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    params.dims[axis] = static_cast<std::uint32_t>(volume.info().dims[axis]);
    params.blocks[axis] = grid.blocks[axis];
  }
  params.dims[3] = key_count(volume.info().type) - 1;
  params.blocks[3] = static_cast<std::uint32_t>(grid.edge);
  params.texel_grid[0] = eye.texel_grid[0];
  params.texel_grid[1] = eye.texel_grid[1];
  params.texel_grid[2] = grid.row_words() * 32;
  gpu::upload_values(device, params_, std::span<const SkipBuildParams>(&params, 1));
}

BitPlanes::BitPlanes(const gpu::Device& device, const BlockGrid& grid, int planes) : count_(planes) {
  const std::uint64_t bytes = bytes_for(grid, planes);
  if (bytes > device.limits().allocation_bytes_max || bytes / 4 > device.limits().texel_buffer_texels_max) {
    throw device_error(
        "{} partitions of {} blocks take {} bytes of bit planes, more than {} gives in one piece: fewer "
        "partitions or "
        "larger blocks fit",
        planes, grid.count(), bytes, device.info().name);
  }
  buffer_ = gpu::Buffer(device, "skip bit planes", bytes, gpu::Memory::device);
  words_ = gpu::TexelBuffer(device, buffer_, gpu::Format::r32_uint);
  quads_ = gpu::TexelBuffer(device, buffer_, gpu::Format::rgba32_uint);
}

BitPlanes::BitPlanes(SkipKernels& kernels, const VolumeOnDevice& volume, const BlockGrid& grid,
                     const Partitioning& partitioning, Occupancy occupancy, const Progress& progress)
    : BitPlanes(kernels.device(), grid, partitioning.count()) {
  gpu::CommandList commands(kernels.device(), "skip clear");
  commands.fill(buffer_, 0);  // the padding, which unions read
  commands.barrier();
  gpu::submit_and_wait(commands);
  PlaneBuilder(kernels, volume, grid, partitioning, occupancy, buffer_).build(progress);
}

BitPlanes::BitPlanes(const gpu::Device& device, const BlockGrid& grid, int planes,
                     std::span<const std::byte> bytes)
    : BitPlanes(device, grid, planes) {
  BRACE_CHECK(bytes.size() == buffer_.size_bytes());
  gpu::upload(device, buffer_, bytes);
}

BitPlane::BitPlane(const gpu::Device& device, const BlockGrid& grid, std::string name)
    : buffer(device, std::move(name), grid.plane_bytes(), gpu::Memory::device),
      words(device, buffer, gpu::Format::r32_uint) {}

std::uint64_t record_union(gpu::CommandList& commands, SkipKernels& kernels, const BlockGrid& grid,
                           const BitPlanes& planes, const std::vector<bool>& visible,
                           const BitPlane& target) {
  BRACE_CHECK(visible.size() == static_cast<std::size_t>(planes.count()));
  const auto quads = static_cast<std::uint32_t>(grid.plane_bytes() / 16);
  std::vector<std::uint32_t> first_quads;
  for (std::size_t p = 0; p < visible.size(); ++p)
    if (visible[p]) first_quads.push_back(static_cast<std::uint32_t>(p) * quads);
  if (first_quads.empty()) {
    commands.fill(target.buffer, 0);
    commands.barrier();
    return grid.plane_bytes();
  }
  return record_merge(commands, kernels, MergeKind::any_bit, {planes.quads(), first_quads, quads},
                      bind_range(kernels.device(), 2, target.buffer, 0, grid.plane_bytes(), "a bit plane"));
}

}  // namespace brace
