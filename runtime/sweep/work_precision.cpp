#include "runtime/sweep/work_precision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brace {

namespace {

bool is_there(const WorkErrorPoint& point) {
  return !std::isnan(point.work) && !std::isnan(point.error);
}

bool beats(const WorkErrorPoint& a, const WorkErrorPoint& b) {
  return a.work <= b.work && a.error <= b.error && (a.work < b.work || a.error < b.error);
}

}  // namespace

std::vector<bool> pareto_front(const std::vector<WorkErrorPoint>& points) {
  std::vector<bool> front;
  for (const WorkErrorPoint& point : points) {
    const bool beaten = std::any_of(points.begin(), points.end(), [&](const WorkErrorPoint& other) {
      return is_there(other) && beats(other, point);
    });
    front.push_back(is_there(point) && !beaten);
  }
  return front;
}

std::optional<double> work_to_reach(const std::vector<WorkErrorPoint>& points, double error_max) {
  std::optional<double> least;
  for (const WorkErrorPoint& point : points) {
    if (is_there(point) && point.error <= error_max && (!least || point.work < *least)) least = point.work;
  }
  return least;
}

double median_of_present(const std::vector<std::optional<double>>& values) {
  std::vector<double> present;
  for (const std::optional<double>& value : values)
    if (value && !std::isnan(*value)) present.push_back(*value);
  if (present.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(present.begin(), present.end());
  const std::size_t half = present.size() / 2;
  return present.size() % 2 == 1 ? present[half] : 0.5 * (present[half - 1] + present[half]);
}

}  // namespace brace
