#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace brace {

/// How much worse a figure may become: the greater of a value in the figure's own unit and a share of A's
/// value.
struct Tolerance {
  double absolute = 0;
  double relative = 0;  // 0.05 is 5 %

  double of(double a) const;
};

/// A `--tolerance` of the command line: for FIGURE (all of its statistics) or FIGURE.STATISTIC.
struct ToleranceChoice {
  std::string figure;
  std::string statistic;  // "": all
  Tolerance tolerance;
};

/// "dssim=0.002", "mtp_rotation_ms.p99=5%". Throws input_error that names the figures there are.
ToleranceChoice parse_tolerance(const std::string& text);

/// The last choice that fits, else `standard`.
Tolerance tolerance_of(std::span<const ToleranceChoice> choices, std::string_view figure,
                       std::string_view statistic, const Tolerance& standard);

}  // namespace brace
