#include "runtime/volume/volume.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/error.hpp"

namespace brace {
namespace {

// Large enough to amortise a call, small enough to stay out of the memory budget of a large volume.
constexpr std::size_t load_slab_bytes = std::size_t{4} << 20;

template <typename T>
double load(std::span<const std::byte> voxels, std::size_t index) {
  T value;
  std::memcpy(&value, voxels.data() + index * sizeof(T), sizeof(T));
  return static_cast<double>(value);
}

}  // namespace

std::size_t bytes_per_voxel(VoxelType type) {
  switch (type) {
    case VoxelType::uint8:
      return 1;
    case VoxelType::int16:
    case VoxelType::uint16:
      return 2;
    case VoxelType::float32:
      return 4;
  }
  BRACE_CHECK(false);
  return 0;
}

std::string_view name_of(VoxelType type) {
  switch (type) {
    case VoxelType::uint8:
      return "uint8";
    case VoxelType::int16:
      return "int16";
    case VoxelType::uint16:
      return "uint16";
    case VoxelType::float32:
      return "float32";
  }
  BRACE_CHECK(false);
  return {};
}

std::int64_t VolumeInfo::voxel_count() const {
  return std::int64_t{dims[0]} * dims[1] * dims[2];
}

std::size_t VolumeInfo::slice_bytes() const {
  return static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]) * bytes_per_voxel(type);
}

std::size_t VolumeInfo::byte_count() const {
  return slice_bytes() * static_cast<std::size_t>(dims[2]);
}

std::array<double, 3> box_size(const VolumeInfo& info) {
  std::array<double, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    size[axis] = info.dims[axis] * info.spacing[axis];
  return size;
}

std::array<double, 3> box_size_with_longest_edge(const VolumeInfo& info, double longest_edge) {
  std::array<double, 3> size = box_size(info);
  const double scale = longest_edge / std::max({size[0], size[1], size[2]});
  for (double& edge : size)
    edge *= scale;
  return size;
}

double voxel_length(const VolumeInfo& info) {
  return std::min({info.spacing[0], info.spacing[1], info.spacing[2]});
}

std::optional<double> spacing_unit_m(const VolumeInfo& info) {
  if (info.spacing_unit == "m") return 1.0;
  if (info.spacing_unit == "mm") return 1e-3;
  if (info.spacing_unit == "um") return 1e-6;
  return std::nullopt;
}

VolumeSource::VolumeSource(VolumeInfo info) : info_(std::move(info)) {}

void VolumeSource::read_slab(std::span<std::byte> out, int z_begin, int z_count) {
  BRACE_CHECK(z_begin == next_z_ && z_count >= 1 && z_count <= info_.dims[2] - z_begin);
  BRACE_CHECK(out.size() == static_cast<std::size_t>(z_count) * info_.slice_bytes());
  produce(out, z_begin, z_count);
  next_z_ += z_count;
}

double voxel_value(VoxelType type, std::span<const std::byte> voxels, std::size_t index) {
  switch (type) {
    case VoxelType::uint8:
      return load<std::uint8_t>(voxels, index);
    case VoxelType::int16:
      return load<std::int16_t>(voxels, index);
    case VoxelType::uint16:
      return load<std::uint16_t>(voxels, index);
    case VoxelType::float32:
      return load<float>(voxels, index);
  }
  BRACE_CHECK(false);
  return 0;
}

double voxel_value(const Volume& volume, int x, int y, int z) {
  const auto& dims = volume.info.dims;
  BRACE_CHECK(x >= 0 && x < dims[0] && y >= 0 && y < dims[1] && z >= 0 && z < dims[2]);
  const std::int64_t index = x + dims[0] * (y + std::int64_t{dims[1]} * z);
  return voxel_value(volume.info.type, volume.voxels, static_cast<std::size_t>(index));
}

Volume load_volume(VolumeSource& source, const Progress& progress) {
  BRACE_CHECK(source.next_z() == 0);
  Volume volume{source.info(), std::vector<std::byte>(source.info().byte_count())};
  const std::size_t slice_bytes = volume.info.slice_bytes();
  const int depth = volume.info.dims[2];
  const int step = slab_slices(volume.info, load_slab_bytes);
  for (int z = 0; z < depth; z += step) {
    const int count = std::min(step, depth - z);
    source.read_slab(std::span(volume.voxels)
                         .subspan(static_cast<std::size_t>(z) * slice_bytes,
                                  static_cast<std::size_t>(count) * slice_bytes),
                     z, count);
    if (progress) progress(static_cast<double>(z + count) / depth);
  }
  return volume;
}

int slab_slices(const VolumeInfo& info, std::size_t budget_bytes) {
  const std::size_t slices = budget_bytes / info.slice_bytes();
  return static_cast<int>(std::clamp<std::size_t>(slices, 1, static_cast<std::size_t>(info.dims[2])));
}

}  // namespace brace
