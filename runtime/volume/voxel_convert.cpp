#include "runtime/volume/voxel_convert.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/error.hpp"

namespace brace {
namespace {

template <typename T>
T load(std::span<const std::byte> from, std::size_t index) {
  T value;
  std::memcpy(&value, from.data() + index * sizeof(T), sizeof(T));
  return value;
}

template <typename T>
void store(std::span<std::byte> to, std::size_t index, T value) {
  std::memcpy(to.data() + index * sizeof(T), &value, sizeof(T));
}

/// Compared in long double, which holds every 64-bit integer and double exactly.
template <typename From>
std::optional<InexactVoxel> to_float_exactly(std::span<const std::byte> from, std::span<std::byte> to) {
  for (std::size_t i = 0; i < from.size() / sizeof(From); ++i) {
    const From value = load<From>(from, i);
    const long double exact = static_cast<long double>(value);
    const bool fits = std::isnan(exact) || std::isinf(exact) ||
                      std::abs(exact) <= static_cast<long double>(std::numeric_limits<float>::max());
    const float rounded = fits ? static_cast<float>(value) : 0.0F;
    if (!std::isnan(exact) && static_cast<long double>(rounded) != exact)
      return InexactVoxel{i, static_cast<double>(value)};
    store(to, i, rounded);
  }
  return std::nullopt;
}

/// What does not fit a float becomes infinite, which the caller's policy on such voxels then meets.
template <typename From>
std::optional<InexactVoxel> to_float_scaled(std::span<const std::byte> from, std::span<std::byte> to,
                                            double slope, double intercept) {
  for (std::size_t i = 0; i < from.size() / sizeof(From); ++i) {
    const double value = slope * static_cast<double>(load<From>(from, i)) + intercept;
    const bool fits = !(std::abs(value) > static_cast<double>(std::numeric_limits<float>::max()));
    store(to, i, fits ? static_cast<float>(value) : (value > 0 ? HUGE_VALF : -HUGE_VALF));
  }
  return std::nullopt;
}

template <typename From>
std::optional<InexactVoxel> to_float(const StoredVolume& stored, std::span<const std::byte> from,
                                     std::span<std::byte> to) {
  if (stored.scaled()) return to_float_scaled<From>(from, to, stored.slope, stored.intercept);
  return to_float_exactly<From>(from, to);
}

void widen_int8(std::span<const std::byte> from, std::span<std::byte> to) {
  for (std::size_t i = 0; i < from.size(); ++i)
    store(to, i, static_cast<std::int16_t>(load<std::int8_t>(from, i)));
}

template <std::size_t size>
void swap_each(std::span<std::byte> voxels) {
  for (std::size_t i = 0; i + size <= voxels.size(); i += size)
    std::reverse(voxels.data() + i, voxels.data() + i + size);
}

}  // namespace

void swap_bytes(std::span<std::byte> voxels, std::size_t bytes_per_voxel) {
  switch (bytes_per_voxel) {
    case 1:
      return;
    case 2:
      return swap_each<2>(voxels);
    case 4:
      return swap_each<4>(voxels);
    case 8:
      return swap_each<8>(voxels);
    default:
      BRACE_CHECK(false);
  }
}

std::optional<InexactVoxel> convert_voxels(const StoredVolume& stored, std::span<const std::byte> from,
                                           std::span<std::byte> to) {
  if (stored.stored_type == StoredType::int8 && !stored.scaled()) {
    widen_int8(from, to);
    return std::nullopt;
  }
  switch (stored.stored_type) {
    case StoredType::int8:
      return to_float<std::int8_t>(stored, from, to);
    case StoredType::uint8:
      return to_float<std::uint8_t>(stored, from, to);
    case StoredType::int16:
      return to_float<std::int16_t>(stored, from, to);
    case StoredType::uint16:
      return to_float<std::uint16_t>(stored, from, to);
    case StoredType::int32:
      return to_float<std::int32_t>(stored, from, to);
    case StoredType::uint32:
      return to_float<std::uint32_t>(stored, from, to);
    case StoredType::int64:
      return to_float<std::int64_t>(stored, from, to);
    case StoredType::uint64:
      return to_float<std::uint64_t>(stored, from, to);
    case StoredType::float32:
      return to_float<float>(stored, from, to);
    case StoredType::float64:
      return to_float<double>(stored, from, to);
  }
  BRACE_CHECK(false);
  return std::nullopt;
}

}  // namespace brace
