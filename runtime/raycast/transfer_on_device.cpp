#include "runtime/raycast/transfer_on_device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.hpp"

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

}  // namespace

TransferOnDevice::TransferOnDevice(const gpu::Device& device, const TransferTable& table, double step_units)
    : buffer_(device, "transfer table", std::uint64_t{max_table_entries} * 16, gpu::Memory::upload) {
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
}

void TransferOnDevice::describe(BraceEyeParams& params) const {
  params.transfer[0] = coordinate_scale_;
  params.transfer[1] = coordinate_offset_;
  params.transfer[2] = last_entry_;
  params.transfer[3] = empty_up_to_;
}

}  // namespace brace
