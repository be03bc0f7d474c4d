#include "runtime/skip/partitioning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/error.hpp"

namespace brace {

namespace {

bool is_integer(VoxelType type) {
  return type != VoxelType::float32;
}

/// Checks a wish for partitions and cuts it to the keys there are.
int usable_count(int n, std::uint32_t keys) {
  if (n < 1 || n > max_partitions)
    throw input_error("{} partitions of the values (accepted: 1 to {})", n, max_partitions);
  return static_cast<int>(std::min<std::uint32_t>(static_cast<std::uint32_t>(n), keys));
}

/// Keys that stand for numbers: those of float32 infinities and NaNs do not.
bool is_finite_key(VoxelType type, std::uint32_t key) {
  const ValueRange range = bin_range(type, key);
  return std::isfinite(range.min) && std::isfinite(range.max);
}

/// Borders of n equal parts of [range.min, range.max] as first keys, appended from the second part on.
void append_uniform_borders(VoxelType type, ValueRange range, int n, std::vector<std::uint32_t>& first_key) {
  // For integers the parts are of [min, max + 1), so that n = number of values gives one value to each.
  const double width = range.max - range.min + (is_integer(type) ? 1.0 : 0.0);
  for (int p = 1; p < n; ++p) {
    const std::uint32_t key = key_at_or_above(type, range.min + width * p / n);
    if (key > first_key.back() && key < key_count(type)) first_key.push_back(key);
  }
}

}  // namespace

std::uint32_t key_count(VoxelType type) {
  return type == VoxelType::uint8 ? 256 : 65536;
}

std::uint32_t key_at_or_above(VoxelType type, double value) {
  std::uint32_t low = 0, high = key_count(type);
  if (!is_integer(type)) {  // skip the NaNs at both ends of the bit patterns
    while (low < high && !is_finite_key(type, low))
      ++low;
    while (high > low && !is_finite_key(type, high - 1))
      --high;
  }
  while (low < high) {
    const std::uint32_t middle = (low + high) / 2;
    if (bin_range(type, middle).max >= value) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

int Partitioning::partition_of(std::uint32_t key) const {
  return static_cast<int>(std::upper_bound(first_key.begin(), first_key.end() - 1, key) - first_key.begin()) -
         1;
}

ValueRange Partitioning::range(int partition) const {
  const auto p = static_cast<std::size_t>(partition);
  std::uint32_t first = first_key[p], last = first_key[p + 1] - 1;
  while (first < last && !is_finite_key(type, first))
    ++first;
  while (last > first && !is_finite_key(type, last))
    --last;
  return {bin_range(type, first).min, bin_range(type, last).max};
}

Partitioning uniform_partitions(VoxelType type, ValueRange data_range, int n) {
  Partitioning result{type, {0}};
  append_uniform_borders(type, data_range, usable_count(n, key_count(type)), result.first_key);
  result.first_key.push_back(key_count(type));
  return result;
}

Partitioning minimum_apart(VoxelType type, ValueRange data_range, int n) {
  const int usable = usable_count(n, key_count(type));
  Partitioning result{type, {0}};
  const std::uint32_t above = key_at_or_above(type, data_range.min) + 1;
  if (usable > 1 && data_range.max > data_range.min && above < key_count(type)) {
    result.first_key.push_back(above);
    append_uniform_borders(type, {bin_range(type, above).min, data_range.max}, usable - 1, result.first_key);
  }
  result.first_key.push_back(key_count(type));
  return result;
}

Partitioning adaptive_partitions(const VoxelStatistics& statistics, std::span<const TransferTable> tables,
                                 int n) {
  const VoxelType type = statistics.type;
  const std::uint32_t keys = key_count(type);
  const auto usable = static_cast<std::size_t>(usable_count(n, keys));
  std::set<std::uint32_t> borders;  // without 0 and keys
  for (const TransferTable& table : tables) {
    const auto below = Visibility(table).visible_below(type);
    for (std::uint32_t k = 1; k < keys && borders.size() + 1 < usable; ++k)
      if ((below[k + 1] - below[k]) != (below[k] - below[k - 1])) borders.insert(k);
  }
  std::vector<std::uint64_t> before(keys + 1, 0);  // voxels below a key
  for (std::uint32_t k = 0; k < keys; ++k)
    before[k + 1] = before[k] + statistics.counts[k];
  while (borders.size() + 1 < usable) {  // cut the fullest partition that can be cut, at its middle voxel
    std::uint64_t fullest = 0;
    std::uint32_t cut = 0, first = 0;
    const auto consider = [&](std::uint32_t end) {
      const std::uint64_t voxels = before[end] - before[first];
      if (end - first > 1 && voxels > fullest) {
        const auto middle = std::upper_bound(before.begin() + first + 1, before.begin() + end - 1,
                                             before[first] + voxels / 2);
        const auto key = static_cast<std::uint32_t>(middle - before.begin());
        if (before[key] != before[first] && before[key] != before[end]) {
          fullest = voxels;
          cut = key;
        } else if (before[key - 1] != before[first] && key - 1 > first) {
          fullest = voxels;
          cut = key - 1;
        }
      }
      first = end;
    };
    for (const std::uint32_t border : borders)
      consider(border);
    consider(keys);
    if (cut == 0) break;
    borders.insert(cut);
  }
  Partitioning result{type, {0}};
  result.first_key.insert(result.first_key.end(), borders.begin(), borders.end());
  result.first_key.push_back(keys);
  return result;
}

Visibility::Visibility(const TransferTable& table, Slack slack) : slack_(slack) {
  last_ = static_cast<double>(table.entries.size() - 1);
  scale_ = last_ / (table.range.max - table.range.min);
  offset_ = -table.range.min * scale_;
  exact_ = scale_ == 1.0 && offset_ == std::floor(offset_) && std::abs(offset_) < 4194304.0;
  positive_below_.assign(table.entries.size() + 1, 0);
  for (std::size_t i = 0; i < table.entries.size(); ++i)
    positive_below_[i + 1] = positive_below_[i] + (table.entries[i][3] > 0.0 ? 1 : 0);
}

bool Visibility::in(ValueRange range) const {
  // What the kernel's single precision may add to a coordinate in the table, generously: value * scale is at
  // most |offset| + last there.
  const double rounding = exact_ ? 0.0 : (std::abs(offset_) + last_) * 0x1p-20;
  const auto slack = [&](double value) {
    return (slack_.relative * std::abs(value + slack_.zero_shift) + slack_.absolute) * scale_ + rounding;
  };
  const double low = std::clamp(range.min * scale_ + offset_ - slack(range.min), 0.0, last_);
  const double high = std::clamp(range.max * scale_ + offset_ + slack(range.max), 0.0, last_);
  // Linear between entries: positive in [low, high] iff an entry at or next to it is.
  const auto first = static_cast<std::size_t>(std::floor(low));
  const auto end = static_cast<std::size_t>(std::ceil(high)) + 1;
  return positive_below_[end] > positive_below_[first];
}

bool Visibility::visible_between_keys(VoxelType type, double low, double high) const {
  return is_integer(type) && high - low == 1.0 && !in({low, low}) && !in({high, high}) && in({low, high});
}

std::vector<bool> Visibility::partitions(const Partitioning& partitioning) const {
  std::vector<bool> visible(static_cast<std::size_t>(partitioning.count()));
  for (int p = 0; p < partitioning.count(); ++p) {
    const ValueRange range = partitioning.range(p);
    const bool has_next = p + 1 < partitioning.count();
    visible[static_cast<std::size_t>(p)] =
        in(range) ||
        (has_next && visible_between_keys(partitioning.type, range.max, partitioning.range(p + 1).min));
  }
  return visible;
}

std::vector<std::uint32_t> Visibility::visible_below(VoxelType type) const {
  const std::uint32_t keys = key_count(type);
  std::vector<std::uint32_t> below(keys + 1, 0);
  for (std::uint32_t k = 0; k < keys; ++k) {
    bool visible = false;
    if (is_finite_key(type, k)) {
      const ValueRange range = bin_range(type, k);
      visible = in(range) || (k + 1 < keys && visible_between_keys(type, range.max, range.max + 1.0));
    }
    below[k + 1] = below[k] + (visible ? 1 : 0);
  }
  return below;
}

std::vector<PartitionRun> runs_of(const std::vector<bool>& visible) {
  std::vector<PartitionRun> runs;
  const int n = static_cast<int>(visible.size());
  for (int p = 0; p < n; ++p) {
    if (!visible[static_cast<std::size_t>(p)]) continue;
    const int begin = p;
    while (p < n && visible[static_cast<std::size_t>(p)])
      ++p;
    runs.push_back({begin, p});
  }
  return runs;
}

}  // namespace brace
