#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace brace {

/// The middle value, or the mean of the middle two; NaNs do not count. NaN where nothing counts.
inline double median(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace brace
