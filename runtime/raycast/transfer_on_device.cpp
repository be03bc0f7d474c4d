#include "runtime/raycast/transfer_on_device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.hpp"
#include "runtime/volume/preintegration.hpp"

namespace brace {

namespace {

/// Table coordinate up to which everything is fully transparent: an entry above zero is felt from the entry
/// before it on.
float empty_up_to(const std::vector<std::array<float, 4>>& entries) {
  const auto visible =
      std::find_if(entries.begin(), entries.end(), [](const auto& entry) { return entry[3] > 0.0f; });
  if (visible == entries.end()) return 1e30f;
  const auto first = static_cast<float>(visible - entries.begin());
  return first == 0.0f ? -1e30f : first - 1.0f;
}

using Texels = std::vector<std::array<float, 4>>;

/// Two texels per entry: the integrals in single precision, and what that rounds off.
Texels integral_texels(const TransferIntegrals& integrals) {
  Texels texels;
  texels.reserve(2 * integrals.size());
  for (const auto& sums : integrals) {
    std::array<float, 4> sum{}, rest{};
    for (std::size_t i = 0; i < sums.size(); ++i) {
      sum[i] = static_cast<float>(sums[i]);
      rest[i] = static_cast<float>(sums[i] - static_cast<double>(sum[i]));
    }
    texels.push_back(sum);
    texels.push_back(rest);
  }
  return texels;
}

void put(const gpu::Device& device, const char* name, gpu::Buffer& buffer, gpu::TexelBuffer& view,
         const Texels& texels) {
  if (buffer.size_bytes() != texels.size() * 16) {
    view = {};
    buffer = gpu::Buffer(device, name, texels.size() * 16, gpu::Memory::device);
    view = gpu::TexelBuffer(device, buffer, gpu::Format::rgba32_float);
  }
  gpu::upload_values(device, buffer, std::span<const std::array<float, 4>>(texels));
}

}  // namespace

TransferOnDevice::TransferOnDevice(const gpu::Device& device, const TransferTable& table, double step_units,
                                   TransferExtras extras)
    : extras_(extras),
      buffer_(device, "transfer table", std::uint64_t{max_table_entries} * 16, gpu::Memory::device),
      texels_(device, buffer_, gpu::Format::rgba32_float) {
  update(device, table, step_units);
}

void TransferOnDevice::update(const gpu::Device& device, const TransferTable& table, double step_units) {
  BRACE_CHECK(step_units > 0.0 && table.range.max > table.range.min);
  BRACE_CHECK(table.entries.size() >= 2 && table.entries.size() <= std::size_t{max_table_entries});
  std::vector<std::array<float, 4>> entries;
  entries.reserve(table.entries.size());
  for (const auto& [r, g, b, kappa] : table.entries) {
    // Transmittance of a step: exp(-kappa step) = 2^-w.
    const double w = kappa * step_units * std::numbers::log2e;
    entries.push_back(
        {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b), static_cast<float>(w)});
  }
  gpu::upload_values(device, buffer_, std::span<const std::array<float, 4>>(entries));
  const double last = static_cast<double>(entries.size() - 1);
  const double scale = last / (table.range.max - table.range.min);
  coordinate_scale_ = static_cast<float>(scale);
  coordinate_offset_ = static_cast<float>(-table.range.min * scale);
  last_entry_ = static_cast<float>(last);
  empty_up_to_ = empty_up_to(entries);
  update_extras(device, table, step_units);
}

void TransferOnDevice::update_extras(const gpu::Device& device, const TransferTable& table,
                                     double step_units) {
  Texels integrals(1), segments(1);
  if (extras_.integrals || extras_.segments) {
    const TransferIntegrals sums = integrate(table, step_units);
    integrals = integral_texels(sums);
    if (extras_.segments) {
      const int size = segment_table_size(table);
      segments = preintegrated_segments(table, sums, step_units, size);
      segments.insert(segments.begin(), {static_cast<float>(size), 0.0f, 0.0f, 0.0f});
    }
  }
  put(device, "transfer integrals", integrals_, integral_texels_, integrals);
  put(device, "transfer segments", segments_, segment_texels_, segments);
}

void TransferOnDevice::describe(BraceEyeParams& params) const {
  params.transfer[0] = coordinate_scale_;
  params.transfer[1] = coordinate_offset_;
  params.transfer[2] = last_entry_;
  params.transfer[3] = empty_up_to_;
}

}  // namespace brace
