#include "runtime/report/decimate.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "runtime/metrics/pacing.hpp"

namespace brace {

namespace {

// 1, 2 or 5 times a power of ten, not below `least`.
double round_width(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (digit * power >= least * (1.0 - 1e-9)) return digit * power;
  }
  return 10.0 * power;
}

}  // namespace

std::vector<CurvePoint> decimate(std::span<const double> x, std::span<const double> y,
                                 std::size_t points_max) {
  BRACE_CHECK(x.size() == y.size() && points_max >= 2);
  std::vector<CurvePoint> points;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isnan(y[i])) points.push_back({x[i], y[i]});
  }
  if (points.size() <= points_max) return points;
  const std::size_t buckets = points_max / 2;
  std::vector<CurvePoint> kept;
  for (std::size_t b = 0; b < buckets; ++b) {
    const auto begin = points.begin() + static_cast<std::ptrdiff_t>(points.size() * b / buckets);
    const auto end = points.begin() + static_cast<std::ptrdiff_t>(points.size() * (b + 1) / buckets);
    const auto lower = [](const CurvePoint& p, const CurvePoint& q) { return p.y < q.y; };
    const auto [least, greatest] = std::minmax_element(begin, end, lower);
    kept.push_back(least < greatest ? *least : *greatest);
    if (least != greatest) kept.push_back(least < greatest ? *greatest : *least);
  }
  return kept;
}

Histogram histogram_of(std::span<const std::vector<double>> groups, int bins_wanted) {
  std::vector<double> all;
  for (const auto& group : groups) {
    std::copy_if(group.begin(), group.end(), std::back_inserter(all),
                 [](double v) { return std::isfinite(v); });
  }
  Histogram histogram;
  histogram.beyond.assign(groups.size(), 0);
  histogram.counts.resize(groups.size());
  if (all.empty()) return histogram;
  std::sort(all.begin(), all.end());
  const double p99 = nearest_rank(all, 99.0);
  const double top = all.back() > 2.0 * p99 && p99 > 0.0 ? 2.0 * p99 : all.back();
  const double span = top - all.front();
  histogram.width = round_width(std::max(span / bins_wanted, 1e-3 * std::max(1.0, std::abs(top))));
  histogram.from = std::floor(all.front() / histogram.width) * histogram.width;
  const auto bins = static_cast<std::size_t>(std::floor((top - histogram.from) / histogram.width)) + 1;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    histogram.counts[g].assign(bins, 0);
    for (const double v : groups[g]) {
      if (std::isnan(v)) continue;
      if (v > top) {
        ++histogram.beyond[g];
        continue;
      }
      const double place = std::max(0.0, (v - histogram.from) / histogram.width);
      ++histogram.counts[g][std::min(bins - 1, static_cast<std::size_t>(place))];
    }
  }
  return histogram;
}

}  // namespace brace
