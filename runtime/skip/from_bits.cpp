#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "runtime/skip/structures.hpp"

namespace brace {

namespace {

struct OctreeParams {
  std::uint32_t children[4], size[4];
};

struct TightParams {
  std::uint32_t blocks[4];
  std::uint32_t row_words, plane_stride, planes_count;
  std::uint32_t padding = 0;
};

}  // namespace

BitmaskStructure::BitmaskStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options,
                                   const Progress& progress)
    : SkipStructure(kernels, scene, options),
      partitioning_(make_partitioning(scene, options)),
      planes_(cached_planes(kernels, scene, grid_, partitioning_, options, progress)),
      occupied_(kernels.device(), grid_, "occupied blocks"),
      map_(kernels.device(), grid_, "distance map") {
  map_.append(1);
  warm_merges(kernels, MergeKind::any_bit, planes_.quads(),
              bind_range(device(), 2, occupied_.buffer, 0, grid_.plane_bytes(), "a bit plane"));
  bind_map(BRACE_SKIP_MAP_DISTANCES, *map_.place(0).buffer, *map_.place(0).words);
}

WorkCounts BitmaskStructure::update(gpu::CommandList& commands, const TransferTable& table) {
  WorkCounts work;
  work.bytes = record_union(commands, *kernels_, grid_, planes_, visibility(table).partitions(partitioning_),
                            occupied_);
  work.bytes += record_transform(commands, *kernels_, grid_, occupied_.words, 0, map_, 0, 1);
  return work;
}

std::uint64_t BitmaskStructure::device_bytes() const {
  return planes_.device_bytes() + occupied_.buffer.size_bytes() + map_.device_bytes();
}

OctreeStructure::OctreeStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options,
                                 const Progress& progress)
    : SkipStructure(kernels, scene, options), partitioning_(make_partitioning(scene, options)) {
  const auto words = static_cast<std::uint32_t>((partitioning_.count() + 31) / 32);
  build(cached_planes(kernels, scene, grid_, partitioning_, options, progress), words);
  bind_map(BRACE_SKIP_MAP_OCTREE, nodes_, node_texels_);
}

void OctreeStructure::build(const BitPlanes& planes, std::uint32_t words) {
  // Levels until one node is left; levels start at multiples of the binding alignment.
  std::array<std::uint32_t, 3> size = {grid_.blocks[0], grid_.blocks[1], grid_.blocks[2]};
  std::uint64_t total_words = 0;
  std::uint32_t levels = 0;
  while (true) {
    BRACE_CHECK(levels < BRACE_SKIP_LEVELS_MAX || size == (std::array<std::uint32_t, 3>{1, 1, 1}));
    auto& level = params_.level[levels++];
    std::copy(size.begin(), size.end(), level);
    level[3] = static_cast<std::uint32_t>(total_words);
    const std::uint64_t bytes = std::uint64_t{size[0]} * size[1] * size[2] * words * 4;
    total_words += BlockGrid::aligned(bytes) / 4;
    if ((size[0] == 1 && size[1] == 1 && size[2] == 1) || levels == BRACE_SKIP_LEVELS_MAX) break;
    for (std::uint32_t& edge : size)
      edge = (edge + 1) / 2;
  }
  if (total_words > device().limits().texel_buffer_texels_max ||
      total_words * 4 > device().limits().allocation_bytes_max) {
    throw device_error(
        "the octree takes {} bytes, more than {} gives in one piece: fewer partitions or larger blocks "
        "fit",
        total_words * 4, device().info().name);
  }
  params_.octree[0] = levels;
  params_.octree[1] = words;
  nodes_ = gpu::Buffer(device(), "skip octree", total_words * 4, gpu::Memory::device);
  node_texels_ = gpu::TexelBuffer(device(), nodes_, gpu::Format::r32_uint);
  const auto level_range = [&](std::uint32_t l) {
    const auto& level = params_.level[l];
    const std::uint64_t bytes = std::uint64_t{level[0]} * level[1] * level[2] * words * 4;
    return bind_range(device(), 2, nodes_, std::uint64_t{level[3]} * 4, BlockGrid::aligned(bytes),
                      "the octree's lowest level");
  };
  gpu::CommandList commands(device(), "skip octree build");
  const TightParams tight{{grid_.blocks[0], grid_.blocks[1], grid_.blocks[2], words},
                          grid_.row_words(),
                          static_cast<std::uint32_t>(grid_.plane_bytes() / 4),
                          static_cast<std::uint32_t>(planes.count())};
  commands.dispatch(kernels_->get("tight_masks"), {gpu::bind(1, planes.words()), level_range(0)},
                    gpu::push_bytes(tight), linear_groups(grid_.count() * words, 64));
  commands.barrier();
  for (std::uint32_t l = 1; l < levels; ++l) {
    OctreeParams params{};
    std::copy_n(params_.level[l - 1], 4, params.children);
    std::copy_n(params_.level[l], 3, params.size);
    params.size[3] = words;
    const std::uint64_t items = std::uint64_t{params.size[0]} * params.size[1] * params.size[2] * words;
    commands.dispatch(kernels_->get("octree"), {gpu::bind(1, node_texels_), level_range(l)},
                      gpu::push_bytes(params), linear_groups(items, 64));
    commands.barrier();
  }
  gpu::submit_and_wait(commands);
}

WorkCounts OctreeStructure::update(gpu::CommandList&, const TransferTable& table) {
  const std::vector<bool> visible = visibility(table).partitions(partitioning_);
  std::uint32_t* words = &params_.visible[0][0];
  std::fill(words, words + 8, 0u);
  for (std::size_t p = 0; p < visible.size(); ++p)
    if (visible[p]) words[p / 32] |= 1u << (p % 32);
  write_params(params_);
  WorkCounts work;
  work.bytes = sizeof(params_.visible);
  return work;
}

std::uint64_t OctreeStructure::device_bytes() const {
  return nodes_.size_bytes();
}

}  // namespace brace
