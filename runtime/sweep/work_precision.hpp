#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace brace {

/// A point of a work-precision diagram; NaN where a run has no such figure.
struct WorkErrorPoint {
  double work = 0.0;
  double error = 0.0;
};

/// Which points no other one beats: none is as good in both and better in one. Points without both figures
/// are never among them; of equal ones all are.
std::vector<bool> pareto_front(const std::vector<WorkErrorPoint>& points);

/// The least work with an error of at most `error_max`; none: not reached.
std::optional<double> work_to_reach(const std::vector<WorkErrorPoint>& points, double error_max);

/// The middle of the values that are there; NaN without any.
double median_of_present(const std::vector<std::optional<double>>& values);

}  // namespace brace
