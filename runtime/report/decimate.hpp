#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace brace {

struct CurvePoint {
  double x = 0, y = 0;
};

/// A curve of at most `points_max` points (an even number of 2 or more) that keeps every peak: up to that
/// many values stay as they are; more are cut into buckets of equally many neighbours, and each bucket gives
/// its least and its greatest value, in the order in which they come. NaN values are no points.
std::vector<CurvePoint> decimate(std::span<const double> x, std::span<const double> y,
                                 std::size_t points_max);

/// Bins of equal, round width over all of the groups, at most about `bins_wanted` of them. Values above twice
/// the 99th percentile are counted in `beyond` instead of stretching the bins. NaN values do not count.
struct Histogram {
  double from = 0;
  double width = 0;
  std::vector<std::vector<std::int64_t>> counts;  // [group][bin]
  std::vector<std::int64_t> beyond;               // [group]
};
Histogram histogram_of(std::span<const std::vector<double>> groups, int bins_wanted);

}  // namespace brace
