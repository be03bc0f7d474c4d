#include "runtime/volume/statistics.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.hpp"

namespace brace {
namespace {

constexpr std::size_t scan_slab_bytes = std::size_t{16} << 20;
constexpr std::size_t bins_of_16_bits = 65536;
constexpr std::uint32_t sign_bit = 0x80000000U;

std::size_t bin_count(VoxelType type) {
  return type == VoxelType::uint8 ? 256 : bins_of_16_bits;
}

/// Float bits in an order that is the values' order: the classic trick of flipping the sign bit of positive
/// and all bits of negative numbers.
std::uint32_t ordered_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & sign_bit) != 0 ? ~bits : bits | sign_bit;
}

float from_ordered_bits(std::uint32_t ordered) {
  return std::bit_cast<float>((ordered & sign_bit) != 0 ? ordered & ~sign_bit : ~ordered);
}

template <typename T>
T load(std::span<const std::byte> voxels, std::size_t index) {
  T value;
  std::memcpy(&value, voxels.data() + index * sizeof(T), sizeof(T));
  return value;
}

/// Runs of equal voxels are common: four tables keep one count from waiting for the one before it.
void count_uint8(std::span<const std::byte> voxels, std::vector<std::uint64_t>& counts) {
  std::array<std::array<std::uint64_t, 256>, 4> tables{};
  for (std::size_t i = 0; i < voxels.size(); ++i)
    ++tables[i % 4][std::to_integer<std::size_t>(voxels[i])];
  for (const auto& table : tables)
    for (std::size_t bin = 0; bin < table.size(); ++bin)
      counts[bin] += table[bin];
}

void count_floats(std::span<const std::byte> voxels, VoxelStatistics& statistics) {
  bool first = statistics.voxels == statistics.not_finite;
  for (std::size_t i = 0; i < voxels.size() / sizeof(float); ++i) {
    const float value = load<float>(voxels, i);
    if (!std::isfinite(value)) {
      ++statistics.not_finite;
      continue;
    }
    ++statistics.counts[ordered_bits(value) >> 16];
    const double exact = static_cast<double>(value);
    statistics.range.min = first ? exact : std::min(statistics.range.min, exact);
    statistics.range.max = first ? exact : std::max(statistics.range.max, exact);
    first = false;
  }
}

/// Some value in [range.min, range.max] has kappa > 0: looked up at its ends and at the entries in between.
bool any_visible(const TransferTable& table, ValueRange range) {
  if (lookup(table, range.min).kappa > 0 || lookup(table, range.max).kappa > 0) return true;
  const double last = static_cast<double>(table.entries.size() - 1);
  const double scale = last / (table.range.max - table.range.min);
  const double first_entry = std::clamp(std::ceil((range.min - table.range.min) * scale), 0.0, last);
  const double last_entry = std::clamp(std::floor((range.max - table.range.min) * scale), 0.0, last);
  for (double entry = first_entry; entry <= last_entry; ++entry)
    if (table.entries[static_cast<std::size_t>(entry)][3] > 0) return true;
  return false;
}

}  // namespace

ValueRange bin_range(VoxelType type, std::size_t bin) {
  BRACE_CHECK(bin < bin_count(type));
  const double index = static_cast<double>(bin);
  switch (type) {
    case VoxelType::uint8:
    case VoxelType::uint16:
      return {index, index};
    case VoxelType::int16:
      return {index - 32768, index - 32768};
    case VoxelType::float32:
      break;
  }
  const auto high_half = static_cast<std::uint32_t>(bin) << 16;
  return {static_cast<double>(from_ordered_bits(high_half)),
          static_cast<double>(from_ordered_bits(high_half | 0xffffU))};
}

VoxelScan::VoxelScan(VoxelType type) {
  statistics_.type = type;
  statistics_.counts.resize(bin_count(type));
}

void VoxelScan::add(std::span<const std::byte> voxels) {
  const std::size_t count = voxels.size() / bytes_per_voxel(statistics_.type);
  BRACE_CHECK(voxels.size() == count * bytes_per_voxel(statistics_.type));
  auto& counts = statistics_.counts;
  switch (statistics_.type) {
    case VoxelType::uint8:
      count_uint8(voxels, counts);
      break;
    case VoxelType::int16:
      for (std::size_t i = 0; i < count; ++i)
        ++counts[static_cast<std::size_t>(load<std::int16_t>(voxels, i) + 32768)];
      break;
    case VoxelType::uint16:
      for (std::size_t i = 0; i < count; ++i)
        ++counts[load<std::uint16_t>(voxels, i)];
      break;
    case VoxelType::float32:
      count_floats(voxels, statistics_);
      break;
  }
  statistics_.voxels += count;
}

VoxelStatistics VoxelScan::result() const {
  VoxelStatistics result = statistics_;
  if (result.type == VoxelType::float32 || result.voxels == 0) return result;
  const auto occupied = [](std::uint64_t count) { return count > 0; };
  const auto first = std::ranges::find_if(result.counts, occupied) - result.counts.begin();
  const auto last =
      result.counts.rend() - std::find_if(result.counts.rbegin(), result.counts.rend(), occupied) - 1;
  result.range.min = bin_range(result.type, static_cast<std::size_t>(first)).min;
  result.range.max = bin_range(result.type, static_cast<std::size_t>(last)).max;
  return result;
}

VoxelStatistics scan(const Volume& volume) {
  VoxelScan voxel_scan(volume.info.type);
  voxel_scan.add(volume.voxels);
  return voxel_scan.result();
}

VoxelStatistics scan(VolumeSource& source, const Progress& progress) {
  const VolumeInfo& info = source.info();
  VoxelScan voxel_scan(info.type);
  const int step = slab_slices(info, scan_slab_bytes);
  std::vector<std::byte> slab(static_cast<std::size_t>(step) * info.slice_bytes());
  const int first = source.next_z();
  for (int z = first; z < info.dims[2]; z += step) {
    const int count = std::min(step, info.dims[2] - z);
    const auto part = std::span(slab).first(static_cast<std::size_t>(count) * info.slice_bytes());
    source.read_slab(part, z, count);
    voxel_scan.add(part);
    if (progress) progress(static_cast<double>(z + count - first) / (info.dims[2] - first));
  }
  return voxel_scan.result();
}

std::vector<std::uint64_t> histogram(const VoxelStatistics& statistics, ValueRange range, int bins) {
  BRACE_CHECK(bins >= 1 && range.max > range.min);
  std::vector<std::uint64_t> result(static_cast<std::size_t>(bins));
  for (std::size_t bin = 0; bin < statistics.counts.size(); ++bin) {
    if (statistics.counts[bin] == 0) continue;
    const ValueRange values = bin_range(statistics.type, bin);
    const double value =
        std::clamp(values.min / 2 + values.max / 2, statistics.range.min, statistics.range.max);
    if (value < range.min || value > range.max) continue;
    const int index = static_cast<int>((value - range.min) / (range.max - range.min) * bins);
    result[static_cast<std::size_t>(std::min(index, bins - 1))] += statistics.counts[bin];
  }
  return result;
}

double occupied_fraction(const VoxelStatistics& statistics, const TransferTable& table) {
  if (statistics.voxels == 0) return 0;
  std::uint64_t occupied = 0;
  for (std::size_t bin = 0; bin < statistics.counts.size(); ++bin)
    if (statistics.counts[bin] > 0 && any_visible(table, bin_range(statistics.type, bin)))
      occupied += statistics.counts[bin];
  return static_cast<double>(occupied) / static_cast<double>(statistics.voxels);
}

double occupied_fraction(const Volume& volume, const TransferTable& table) {
  const auto count = static_cast<std::size_t>(volume.info.voxel_count());
  std::size_t occupied = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (lookup(table, voxel_value(volume.info.type, volume.voxels, i)).kappa > 0) ++occupied;
  return static_cast<double>(occupied) / static_cast<double>(count);
}

}  // namespace brace
