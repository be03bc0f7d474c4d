#include "tools/live/transfer_edit.hpp"

#include <algorithm>
#include <cmath>

namespace brace {

void move_point(TransferFunction& tf, std::size_t index, double value, double opacity, ValueRange range) {
  const double gap = value_gap * (range.max - range.min);
  const double low = index > 0 ? tf.points[index - 1].value + gap : range.min;
  const double high = index + 1 < tf.points.size() ? tf.points[index + 1].value - gap : range.max;
  TransferPoint& point = tf.points[index];
  if (low <= high) point.value = std::clamp(value, low, high);
  point.sample.kappa = kappa_from_opacity(std::clamp(opacity, 0.0, 1.0), 1.0);
}

std::size_t add_point(TransferFunction& tf, double value, ValueRange range) {
  const double gap = value_gap * (range.max - range.min);
  const double inside = std::clamp(value, range.min, range.max);
  const auto after = std::find_if(tf.points.begin(), tf.points.end(),
                                  [&](const TransferPoint& point) { return point.value > inside - gap; });
  const auto index = static_cast<std::size_t>(after - tf.points.begin());
  if (after != tf.points.end() && after->value < inside + gap) return index;
  tf.points.insert(after, {inside, evaluate(tf, inside)});
  return index;
}

void remove_point(TransferFunction& tf, std::size_t index) {
  if (tf.points.size() > 1) tf.points.erase(tf.points.begin() + static_cast<std::ptrdiff_t>(index));
}

std::vector<float> log_bars(const VoxelStatistics& statistics, ValueRange range, int bins) {
  const std::vector<std::uint64_t> counts = histogram(statistics, range, bins);
  std::uint64_t most = counts.size() > 1 ? *std::max_element(counts.begin() + 1, counts.end()) : 0;
  if (most == 0) most = counts.empty() ? 0 : counts.front();
  std::vector<float> bars;
  for (const std::uint64_t count : counts) {
    const double height =
        most > 0 ? std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most)) : 0.0;
    bars.push_back(static_cast<float>(std::min(height, 1.0)));
  }
  return bars;
}

}  // namespace brace
