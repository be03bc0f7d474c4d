#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace brace::sim {

/// Nearest-rank percentile of ascending values: the smallest value with at least `fraction` of them at or
/// below it. 0 for none.
inline double nearest_rank(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) return 0.0;
  const double rank = std::ceil(fraction * static_cast<double>(sorted.size()));
  const auto index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  return sorted[std::min(index, sorted.size() - 1)];
}

struct Spread {
  double mean = 0, p95 = 0, p99 = 0, max = 0;
};

inline Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return {sum / static_cast<double>(values.size()), nearest_rank(values, 0.95), nearest_rank(values, 0.99),
          values.back()};
}

}  // namespace brace::sim
