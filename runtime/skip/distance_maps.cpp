#include "runtime/skip/distance_maps.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/skip/merge.hpp"

namespace brace {

namespace {

struct DistanceXParams {
  std::uint32_t quads, row_quads, row_words, plane_stride, map_stride, first_plane;
};
struct DistanceYParams {
  std::uint32_t row_quads, rows, map_stride;
};
struct DistanceZParams {
  std::uint32_t row_quads, rows, map_stride, from, to, base;
};

/// The transform of maps that lie one after the other in one buffer.
class TransformRecorder {
 public:
  TransformRecorder(gpu::CommandList& commands, SkipKernels& kernels, const BlockGrid& grid,
                    const DistanceMaps::Place& place, std::uint32_t maps)
      : commands_(commands),
        kernels_(kernels),
        grid_(grid),
        place_(place),
        maps_(maps),
        stride_(static_cast<std::uint32_t>(grid.map_bytes() / 16)),
        target_(bind_range(kernels.device(), 2, *place.buffer, std::uint64_t{place.index} * grid.map_bytes(),
                           std::uint64_t{maps} * grid.map_bytes(), "a distance map")) {}

  void along_x(const gpu::TexelBuffer& planes, std::uint32_t first_plane) {
    const DistanceXParams params{grid_.map_quads(), grid_.row_quads(),
                                 grid_.row_words(), static_cast<std::uint32_t>(grid_.plane_bytes() / 4),
                                 stride_,           first_plane};
    commands_.dispatch(kernels_.get("distance_x"), {gpu::bind(1, planes), target_}, gpu::push_bytes(params),
                       linear_groups(grid_.map_quads(), 64, maps_));
    commands_.barrier();
  }

  void along_y() {
    if (grid_.blocks[1] < 2) return;
    const std::uint32_t local = std::clamp((grid_.row_quads() + 7) / 8 * 8, 8u, 64u);
    const DistanceYParams params{grid_.row_quads(), grid_.blocks[1], stride_};
    commands_.dispatch(kernels_.get("distance_y", {{"BRACE_LOCAL", std::to_string(local)}}), {target_},
                       gpu::push_bytes(params), {grid_.blocks[2], maps_, 1});
    commands_.barrier();
  }

  void along_z() {
    const std::uint32_t last = grid_.blocks[2] - 1;
    for (std::uint32_t z = 0; z < last; ++z)
      step_z(z, z + 1);
    for (std::uint32_t z = last; z > 0; --z)
      step_z(z, z - 1);
  }

 private:
  void step_z(std::uint32_t from, std::uint32_t to) {
    const std::uint32_t slice = grid_.row_quads() * grid_.blocks[1];
    const DistanceZParams params{grid_.row_quads(), grid_.blocks[1], stride_,
                                 from * slice,      to * slice,      place_.index * stride_};
    commands_.dispatch(
        kernels_.get("distance_z"), {gpu::bind(1, *place_.quads), target_}, gpu::push_bytes(params),
        linear_groups(std::uint64_t{grid_.row_quads()} * ((grid_.blocks[1] + 3) / 4), 64, maps_));
    commands_.barrier();
  }

  gpu::CommandList& commands_;
  SkipKernels& kernels_;
  const BlockGrid& grid_;
  DistanceMaps::Place place_;
  std::uint32_t maps_, stride_;
  gpu::Binding target_;
};

}  // namespace

DistanceMaps::DistanceMaps(const gpu::Device& device, const BlockGrid& grid, std::string name)
    : device_(&device), map_bytes_(grid.map_bytes()), name_(std::move(name)) {}

int DistanceMaps::append(int count) {
  const gpu::DeviceLimits& limits = device_->limits();
  const std::uint64_t bytes_max = std::min(limits.allocation_bytes_max, limits.texel_buffer_texels_max * 4);
  const int fit = static_cast<int>(std::min<std::uint64_t>(bytes_max / map_bytes_, 1 << 20));
  if (fit < 1) {
    throw device_error("a distance map takes {} bytes, more than {} gives in one piece: larger blocks fit",
                       map_bytes_, device_->info().name);
  }
  const int first = count_;
  while (count > 0) {
    Piece piece;
    piece.first = count_;
    piece.count = std::min(count, fit);
    piece.buffer = gpu::Buffer(*device_, name_, static_cast<std::uint64_t>(piece.count) * map_bytes_,
                               gpu::Memory::device);
    piece.quads = gpu::TexelBuffer(*device_, piece.buffer, gpu::Format::rgba32_uint);
    piece.words = gpu::TexelBuffer(*device_, piece.buffer, gpu::Format::r32_uint);
    count_ += piece.count;
    count -= piece.count;
    pieces_.push_back(std::move(piece));
  }
  return first;
}

DistanceMaps::Place DistanceMaps::place(int map) const {
  BRACE_CHECK(map >= 0 && map < count_);
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), map,
                                      [](int wanted, const Piece& piece) { return wanted < piece.first; });
  const Piece& piece = *(after - 1);
  Place place;
  place.buffer = &piece.buffer;
  place.quads = &piece.quads;
  place.words = &piece.words;
  place.index = static_cast<std::uint32_t>(map - piece.first);
  place.piece = static_cast<std::uint32_t>(after - 1 - pieces_.begin());
  place.maps_after = static_cast<std::uint32_t>(piece.count) - place.index;
  return place;
}

std::uint64_t record_transform(gpu::CommandList& commands, SkipKernels& kernels, const BlockGrid& grid,
                               const gpu::TexelBuffer& planes, int first_plane, const DistanceMaps& maps,
                               int first_map, int count) {
  const auto bound_max = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
      kernels.device().limits().storage_buffer_bytes_max / grid.map_bytes(), 1, 64));
  for (int done = 0; done < count;) {
    const DistanceMaps::Place place = maps.place(first_map + done);
    const std::uint32_t batch =
        std::min({bound_max, place.maps_after, static_cast<std::uint32_t>(count - done)});
    TransformRecorder recorder(commands, kernels, grid, place, batch);
    recorder.along_x(planes, static_cast<std::uint32_t>(first_plane + done));
    recorder.along_y();
    recorder.along_z();
    done += static_cast<int>(batch);
  }
  // x writes, the four sweeps read and write and read their neighbours.
  return static_cast<std::uint64_t>(count) * (grid.plane_bytes() + 13 * grid.map_bytes());
}

std::uint64_t record_minimum(gpu::CommandList& commands, SkipKernels& kernels, const BlockGrid& grid,
                             const DistanceMaps& maps, std::span<const int> sources,
                             const DistanceMaps& target, int target_map) {
  const DistanceMaps::Place to = target.place(target_map);
  const std::uint64_t to_offset = std::uint64_t{to.index} * grid.map_bytes();
  if (sources.empty()) {
    commands.fill(*to.buffer, 0x7f7f7f7fu, to_offset, grid.map_bytes());
    commands.barrier();
    return grid.map_bytes();
  }
  const auto quads = static_cast<std::uint32_t>(grid.map_bytes() / 16);
  const gpu::Binding written =
      bind_range(kernels.device(), 2, *to.buffer, to_offset, grid.map_bytes(), "a distance map");
  std::uint64_t bytes = 0;
  std::vector<std::uint32_t> first_quads;
  for (std::size_t i = 0; i < sources.size();) {
    const DistanceMaps::Place piece = maps.place(sources[i]);
    first_quads.clear();
    for (; i < sources.size(); ++i) {
      const DistanceMaps::Place next = maps.place(sources[i]);
      if (next.piece != piece.piece) break;
      first_quads.push_back(next.index * quads);
    }
    bytes += record_merge(commands, kernels, MergeKind::smallest_byte, {*piece.quads, first_quads, quads},
                          written, bytes > 0);
  }
  return bytes;
}

}  // namespace brace
