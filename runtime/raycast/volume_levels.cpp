#include "runtime/raycast/volume_levels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "plugins/abi/glsl/brace/level_params.h"
#include "runtime/raycast/packed_layout.hpp"

namespace brace {

namespace {

constexpr std::uint32_t slot_level_voxels = 42, slot_level_table = 43;
constexpr int edge_min = 4;
constexpr int levels_max = 8;

/// How much of the unit interval of source `i` of `n` the target `j` of `m` covers, as a share of the target.
double box_weight(int i, int n, int j, int m) {
  const double length = static_cast<double>(n) / m;
  const double begin = std::max(static_cast<double>(i), j * length);
  const double end = std::min(i + 1.0, (j + 1) * length);
  return std::max(end - begin, 0.0) / length;
}

/// Calls part(i, weight) for the sources of a target.
template <typename Part>
void for_each_source(int j, int n, int m, const Part& part) {
  const auto first = static_cast<int>(std::int64_t{j} * n / m);
  const auto last = static_cast<int>((std::int64_t{j + 1} * n + m - 1) / m);
  for (int i = first; i < std::min(last, n); ++i)
    part(i, box_weight(i, n, j, m));
}

/// Means over boxes along x and y.
std::vector<double> halve_slice(std::span<const double> values, const std::array<int, 3>& from,
                                const std::array<int, 3>& to) {
  const auto at = [](int x, int y, int width) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  std::vector<double> narrow(at(0, from[1], to[0]));
  for (int y = 0; y < from[1]; ++y) {
    for (int x = 0; x < to[0]; ++x) {
      double sum = 0.0;
      for_each_source(x, from[0], to[0], [&](int i, double w) { sum += w * values[at(i, y, from[0])]; });
      narrow[at(x, y, to[0])] = sum;
    }
  }
  std::vector<double> out(at(0, to[1], to[0]));
  for (int y = 0; y < to[1]; ++y) {
    for_each_source(y, from[1], to[1], [&](int i, double w) {
      for (int x = 0; x < to[0]; ++x)
        out[at(x, y, to[0])] += w * narrow[at(x, i, to[0])];
    });
  }
  return out;
}

/// int16 lies in the buffer as value + 32768.
double bias_of(VoxelType type) {
  return type == VoxelType::int16 ? 32768.0 : 0.0;
}

std::vector<double> values_of(std::span<const std::byte> voxels, VoxelType type) {
  const std::size_t size = bytes_per_voxel(type);
  std::vector<double> values(voxels.size() / size);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::byte* at = voxels.data() + i * size;
    const auto read = [&]<typename Voxel>(Voxel voxel) {
      std::memcpy(&voxel, at, sizeof voxel);
      values[i] = static_cast<double>(voxel);
    };
    switch (type) {
      case VoxelType::uint8:
        read(std::uint8_t{});
        break;
      case VoxelType::int16:
        read(std::int16_t{});
        break;
      case VoxelType::uint16:
        read(std::uint16_t{});
        break;
      case VoxelType::float32:
        read(float{});
        break;
    }
  }
  return values;
}

/// The voxels of a slice as they lie in the buffer before they are packed.
std::vector<std::byte> voxels_of(std::span<const double> values, VoxelType type) {
  const std::size_t size = bytes_per_voxel(type);
  std::vector<std::byte> voxels(values.size() * size);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto write = [&](auto voxel) { std::memcpy(voxels.data() + i * size, &voxel, sizeof voxel); };
    const double stored = values[i] + bias_of(type);
    switch (type) {
      case VoxelType::uint8:
        write(static_cast<std::uint8_t>(std::lround(stored)));
        break;
      case VoxelType::int16:
      case VoxelType::uint16:
        write(static_cast<std::uint16_t>(std::lround(stored)));
        break;
      case VoxelType::float32:
        write(static_cast<float>(stored));
        break;
    }
  }
  return voxels;
}

VolumeInfo level_info(const VolumeInfo& volume, int level) {
  VolumeInfo info = volume;
  info.dims = level_dims(volume, level);
  return info;
}

}  // namespace

int coarser_levels(const VolumeInfo& volume) {
  const int shortest = *std::min_element(volume.dims.begin(), volume.dims.end());
  int levels = 0;
  while (levels < levels_max && (shortest >> (levels + 1)) >= edge_min)
    ++levels;
  return levels;
}

std::array<int, 3> level_dims(const VolumeInfo& volume, int level) {
  std::array<int, 3> dims{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    dims[axis] = volume.dims[axis] >> level;
  return dims;
}

LevelBuilder::LevelBuilder(const VolumeInfo& volume, Slice slice) : slice_(std::move(slice)) {
  for (int level = 0; level <= coarser_levels(volume); ++level) {
    Level& made = levels_.emplace_back();
    made.dims = level_dims(volume, level);
    const std::size_t area = static_cast<std::size_t>(made.dims[0]) * static_cast<std::size_t>(made.dims[1]);
    if (level > 0) made.open.assign(area, 0.0), made.next.assign(area, 0.0);
  }
}

void LevelBuilder::add(int level, std::span<const double> values) {
  const auto above = static_cast<std::size_t>(level) + 1;
  if (above >= levels_.size()) return;
  const std::array<int, 3>& from = levels_[above - 1].dims;
  Level& to = levels_[above];
  const std::vector<double> halved = halve_slice(values, from, to.dims);
  // A box along z is two or three slices, whole or in part; no slice is in more than two boxes.
  const int z = to.slices_in++;
  const double here = box_weight(z, from[2], to.slices_out, to.dims[2]);
  const double beyond = box_weight(z, from[2], to.slices_out + 1, to.dims[2]);
  for (std::size_t i = 0; i < halved.size(); ++i) {
    to.open[i] += here * halved[i];
    to.next[i] += beyond * halved[i];
  }
  if (std::int64_t{z + 1} * to.dims[2] < std::int64_t{to.slices_out + 1} * from[2]) return;
  slice_(level + 1, to.slices_out++, to.open);
  add(level + 1, to.open);
  std::swap(to.open, to.next);
  std::fill(to.next.begin(), to.next.end(), 0.0);
}

VolumeLevels::VolumeLevels(const gpu::Device& device, VolumeSource& source)
    : info_(source.info()), count_(coarser_levels(info_)) {
  std::vector<PackedLayout> layouts;
  std::vector<std::uint64_t> first_texels;
  BraceLevelTable table{};
  table.last[0] = static_cast<std::uint32_t>(count_);
  std::uint64_t texels = 0;
  for (int level = 1; level <= count_; ++level) {
    const PackedLayout& layout = layouts.emplace_back(level_info(info_, level));
    first_texels.push_back(texels);
    BraceLevel& entry = table.levels[level];
    entry.place[0] = static_cast<std::uint32_t>(texels);
    entry.place[1] = layout.row_texels;
    entry.place[2] = static_cast<std::uint32_t>(layout.slice_texels);
    for (std::size_t axis = 0; axis < 3; ++axis)
      entry.scale[axis] = static_cast<float>(static_cast<double>(layout.dims[axis]) / info_.dims[axis]);
    texels += layout.texels();
  }
  const gpu::DeviceLimits& limits = device.limits();
  if (texels > limits.texel_buffer_texels_max || texels * 4 > limits.allocation_bytes_max) {
    throw device_error(
        "{}: the coarser levels that stage.dvr.lod asks for take {} texels of 4 bytes, but {} binds {} and "
        "allocates {} bytes at once: accepted: lod = \"off\"",
        info_.source, texels, device.info().name, limits.texel_buffer_texels_max,
        limits.allocation_bytes_max);
  }
  voxels_ = gpu::Buffer(device, "volume levels", std::max<std::uint64_t>(texels, 1) * 4, gpu::Memory::device);
  texels_ = gpu::TexelBuffer(
      device, voxels_, info_.type == VoxelType::float32 ? gpu::Format::r32_float : gpu::Format::r32_uint);
  table_ = gpu::Buffer(device, "level table", sizeof table, gpu::Memory::upload);
  gpu::upload_values(device, table_, std::span<const BraceLevelTable>(&table, 1));
  bindings_ = {gpu::bind(slot_level_voxels, texels_), gpu::bind(slot_level_table, table_)};

  LevelBuilder builder(info_, [&](int level, int z, std::span<const double> values) {
    const PackedLayout& layout = layouts[static_cast<std::size_t>(level - 1)];
    std::vector<std::uint32_t> packed(layout.slice_texels);
    pack_slice(layout, voxels_of(values, info_.type), packed);
    const auto bytes = std::as_bytes(std::span(packed));
    const auto put = [&](int at) {
      const std::uint64_t texel = first_texels[static_cast<std::size_t>(level - 1)] +
                                  static_cast<std::uint64_t>(at) * layout.slice_texels;
      gpu::upload(device, voxels_, bytes, texel * 4);
    };
    put(z + 1);
    if (z == 0) put(0);
    if (z + 1 == layout.dims[2]) put(z + 2);
  });
  std::vector<std::byte> slice(info_.slice_bytes());
  for (int z = 0; count_ > 0 && z < info_.dims[2]; ++z) {
    source.read_slab(slice, z, 1);
    builder.add(values_of(slice, info_.type));
  }
}

std::string VolumeLevels::summary() const {
  if (count_ == 0) return "none: an edge of the volume is below 8 voxels";
  const auto coarsest = level_dims(info_, count_);
  return fmt::format("{} coarser levels, down to {} x {} x {} voxels, take {} bytes beside the volume",
                     count_, coarsest[0], coarsest[1], coarsest[2], device_bytes());
}

std::vector<std::pair<std::string, std::string>> VolumeLevels::defines() const {
  const char* access = info_.type == VoxelType::uint8     ? "BRACE_LEVELS_8"
                       : info_.type == VoxelType::float32 ? "BRACE_LEVELS_32"
                                                          : "BRACE_LEVELS_16";
  return {{"BRACE_VOLUME_LEVELS", "1"}, {access, "1"}};
}

}  // namespace brace
