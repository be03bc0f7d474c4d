#pragma once

#include <string>
#include <vector>

#include "runtime/verify/verify.hpp"

namespace brace {

// Plots as SVG text for a page that needs no script. Colours are those of report.css.

/// Error over samples, both axes logarithmic: a curve per rule of one problem, with a legend.
std::string error_plot(const std::vector<const ErrorCurve*>& curves);

/// A row per rule, a cell per decade of κΔt: the larger the error, the darker; struck through where the rule
/// leaves the bounds.
std::string stability_map(const std::vector<const StabilityRow*>& rows);

/// For text between tags and in attributes.
std::string html_text(const std::string& text);

}  // namespace brace
