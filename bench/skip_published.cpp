#include "bench/skip_published.hpp"

#include <algorithm>

namespace brace::bench {

namespace {

gpu::ImageShape shape_of(const BlockGrid& grid) {
  return {static_cast<int>(grid.blocks[0]), static_cast<int>(grid.blocks[1]),
          static_cast<int>(grid.blocks[2])};
}

double run_ms(gpu::CommandList& commands) {
  double ms = 0;
  for (const gpu::Timing& timing : gpu::submit_and_wait(commands))
    ms += static_cast<double>(timing.device_ns) * 1e-6;
  return ms;
}

}  // namespace

PublishedMaps::PublishedMaps(const gpu::Device& device, const VolumeOnDevice& volume,
                             const std::filesystem::path& kernels_folder)
    : device_(&device),
      volume_(&volume),
      grid_(volume.info(), 4),
      kernels_(device, kernels_folder),
      sampler_(device, "maps", gpu::Filter::nearest, gpu::Address::clamp_to_edge),
      transfer_(device, "transfer function", 256, 1, gpu::Format::r32_float) {
  for (gpu::Image3D& image : flip_)
    image = gpu::Image3D(device, "map", shape_of(grid_), gpu::Format::r8_uint);
}

double PublishedMaps::recompute_ms(const TransferTable& table) {
  std::array<float, 256> alpha{};
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] = static_cast<float>(table.entries[i][3]);
  gpu::upload(*device_, transfer_, std::as_bytes(std::span(alpha)));
  const std::array<std::uint32_t, 3> groups = {(grid_.blocks[0] + 7) / 8, (grid_.blocks[1] + 7) / 8,
                                               grid_.blocks[2]};
  gpu::CommandList commands(*device_, "published");
  commands.begin_timing("recompute");
  commands.dispatch(kernels_.get("occupancy"),
                    {volume_->binding(0), gpu::bind(1, transfer_, sampler_), gpu::bind(2, flip_[0])}, {},
                    groups);
  commands.barrier();
  for (int axis = 0; axis < 3; ++axis) {
    const auto from = static_cast<std::size_t>(axis % 2);
    commands.dispatch(kernels_.get("transform"), {sampled(0, flip_[from]), gpu::bind(2, flip_[1 - from])},
                      gpu::push_bytes(axis), groups);
    commands.barrier();
  }
  commands.end_timing();
  return run_ms(commands);
}

void PublishedMaps::make_maps(int count) {
  maps_.clear();
  std::vector<std::byte> bytes(grid_.count());
  std::uint32_t state = 1;
  for (int map = 0; map < count; ++map) {
    for (std::byte& byte : bytes) {
      state = state * 1664525u + 1013904223u;
      byte = static_cast<std::byte>(state >> 25);
    }
    maps_.emplace_back(*device_, "partitioned map", shape_of(grid_), gpu::Format::r8_uint);
    gpu::upload(*device_, maps_.back(), bytes);
  }
}

double PublishedMaps::merge_ms(int count) {
  const std::array<std::uint32_t, 3> groups = {(grid_.blocks[0] + 7) / 8, (grid_.blocks[1] + 7) / 8,
                                               grid_.blocks[2]};
  const std::array<std::uint32_t, 6> slots = {1, 3, 4, 5, 6, 7};
  gpu::CommandList commands(*device_, "published merge");
  commands.begin_timing("merge");
  for (int done = 0; done < count; done += 6) {
    struct {
      std::int32_t maps, onto;
    } const params{std::min(6, count - done), done > 0};
    const auto to = static_cast<std::size_t>(done / 6 % 2);
    std::vector<gpu::Binding> bindings = {sampled(0, flip_[1 - to]), gpu::bind(2, flip_[to])};
    for (int i = 0; i < 6; ++i) {
      const auto map = static_cast<std::size_t>(std::min(done + i, count - 1));
      bindings.push_back(sampled(slots[static_cast<std::size_t>(i)], maps_[map]));
    }
    commands.dispatch(kernels_.get("merge"), bindings, gpu::push_bytes(params), groups);
    commands.barrier();
  }
  commands.end_timing();
  return run_ms(commands);
}

}  // namespace brace::bench
