#include "runtime/verify/svg_plot.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace brace {

namespace {

/// A logarithmic axis from a to b pixels over whole decades.
struct LogAxis {
  double low = 0, high = 1;  // exponents
  double from_px = 0, to_px = 1;
  double at(double value) const {
    return from_px + (std::log10(value) - low) / (high - low) * (to_px - from_px);
  }
};

constexpr double kErrorFloor = 1e-8;  // single precision shows nothing below

std::string power(int exponent) {
  static const char* const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char c : std::to_string(std::abs(exponent)))
    text += digits[c - '0'];
  return text;
}

const char* const kMarks[] = {"circle", "square", "diamond", "triangle", "cross"};

std::string mark(std::size_t which, double x, double y) {
  const std::string kind = kMarks[which % std::size(kMarks)];
  if (kind == "circle") return fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='3.5'/>", x, y);
  if (kind == "square")
    return fmt::format("<rect x='{:.1f}' y='{:.1f}' width='7' height='7'/>", x - 3.5, y - 3.5);
  if (kind == "diamond")
    return fmt::format("<path d='M{:.1f} {:.1f}l4.5 4.5l-4.5 4.5l-4.5 -4.5z'/>", x, y - 4.5);
  if (kind == "triangle") return fmt::format("<path d='M{:.1f} {:.1f}l4.5 8h-9z'/>", x, y - 4.5);
  return fmt::format("<path d='M{0:.1f} {1:.1f}l8 8m0 -8l-8 8' stroke='currentColor' stroke-width='2'/>",
                     x - 4, y - 4);
}

}  // namespace

std::string html_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '<') {
      safe += "&lt;";
    } else if (c == '&') {
      safe += "&amp;";
    } else if (c == '"') {
      safe += "&quot;";
    } else if (c == '\'') {
      safe += "&#39;";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string error_plot(const std::vector<const ErrorCurve*>& curves) {
  constexpr double width = 520, height = 300;
  double fewest = 1e300, most = 1, smallest = 1, largest = kErrorFloor;
  for (const ErrorCurve* curve : curves) {
    for (const auto& [samples, error] : curve->points) {
      fewest = std::min(fewest, samples);
      most = std::max(most, samples);
      smallest = std::min(smallest, std::max(error, kErrorFloor));
      largest = std::max(largest, error);
    }
  }
  const LogAxis x{std::log10(fewest) - 0.08, std::log10(most) + 0.08, 58, width - 12};
  const LogAxis y{std::floor(std::log10(smallest)), std::ceil(std::log10(largest) + 1e-9), height - 44, 12};
  std::string svg = fmt::format(
      "<svg viewBox='0 0 {} {}' role='img' aria-label='Error over samples' font-size='12' "
      "fill='currentColor'>",
      width, height);
  for (int e = static_cast<int>(y.low); e <= static_cast<int>(y.high); ++e) {
    const double at = y.at(std::pow(10.0, e));
    svg += fmt::format(
        "<line x1='{}' x2='{}' y1='{:.1f}' y2='{:.1f}' stroke='var(--grid)'/><text x='52' y='{:.1f}' "
        "text-anchor='end'>{}</text>",
        x.from_px, x.to_px, at, at, at + 4, power(e));
  }
  std::vector<double> ticks;
  for (const auto& point : curves.front()->points)
    ticks.push_back(point[0]);
  std::sort(ticks.begin(), ticks.end());
  for (const double tick : ticks) {
    svg += fmt::format("<text x='{:.1f}' y='{}' text-anchor='middle'>{:.0f}</text>", x.at(tick), height - 26,
                       tick);
  }
  svg += fmt::format("<text x='{}' y='{}' text-anchor='middle'>samples</text>", (x.from_px + x.to_px) / 2,
                     height - 6);
  svg += fmt::format("<text x='14' y='{0}' text-anchor='middle' transform='rotate(-90 14 {0})'>error</text>",
                     (height - 32) / 2);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::string path, marks;
    for (const auto& [samples, error] : curves[i]->points) {
      const double px = x.at(samples), py = y.at(std::max(error, kErrorFloor));
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", px, py);
      marks += fmt::format("<g><title>{}: {:.0f} samples, error {:.2g}</title>{}</g>",
                           html_text(curves[i]->rule), samples, error, mark(i, px, py));
    }
    svg += fmt::format(
        "<g style='color:var(--series-{0});fill:var(--series-{0})'><path d='{1}' fill='none' "
        "stroke='currentColor' "
        "stroke-width='2'/>{2}</g>",
        i % 5 + 1, path, marks);
  }
  svg += "</svg><ul class='legend'>";
  for (std::size_t i = 0; i < curves.size(); ++i) {
    svg += fmt::format(
        "<li style='color:var(--series-{0})'><svg width='14' height='12' viewBox='0 0 14 12' "
        "fill='currentColor' "
        "aria-hidden='true'>{1}</svg> <span style='color:var(--text)'>{2}</span></li>",
        i % 5 + 1, mark(i, 7, 6), html_text(curves[i]->rule));
  }
  return svg + "</ul>";
}

std::string stability_map(const std::vector<const StabilityRow*>& rows) {
  constexpr double left = 310, cell = 24, row_height = 22, top = 8;
  const double width = left + cell * 25 + 10;
  const double height = top + row_height * static_cast<double>(rows.size()) + 40;
  std::string svg = fmt::format(
      "<svg viewBox='0 0 {} {}' role='img' aria-label='Error per rule and stiffness' font-size='12' "
      "fill='currentColor' style='min-width:760px'>",
      width, height);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double y = top + row_height * static_cast<double>(row);
    const std::string name =
        rows[row]->precision == "device" ? rows[row]->rule : rows[row]->rule + ", " + rows[row]->precision;
    svg += fmt::format("<text x='{}' y='{}' text-anchor='end'>{}</text>", left - 8, y + 15, html_text(name));
    for (std::size_t i = 0; i < rows[row]->errors.size(); ++i) {
      const double error = rows[row]->errors[i];
      const double x = left + cell * static_cast<double>(i);
      const int exponent = static_cast<int>(i) - 12;
      if (std::isfinite(error)) {
        // From 1e-8 (light) to 0.1 (dark).
        const double shade = std::clamp((std::log10(std::max(error, 1e-12)) + 8) / 7, 0.04, 1.0);
        svg += fmt::format(
            "<rect x='{}' y='{}' width='{}' height='{}' fill='var(--series-1)' fill-opacity='{:.2f}' "
            "stroke='var(--line)'><title>{}, κΔt = {}: error {:.2g}</title></rect>",
            x, y, cell - 2, row_height - 2, shade, html_text(name), power(exponent), error);
      } else {
        svg += fmt::format(
            "<g><title>{}, κΔt = {}: out of bounds</title><rect x='{}' y='{}' width='{}' height='{}' "
            "fill='var(--missed)' fill-opacity='0.35' stroke='var(--missed)'/><path d='M{} {}l10 10m0 "
            "-10l-10 10' "
            "stroke='var(--missed)' stroke-width='2'/></g>",
            html_text(name), power(exponent), x, y, cell - 2, row_height - 2, x + 6, y + 5);
      }
    }
  }
  const double bottom = height - 22;
  for (int exponent = -12; exponent <= 12; exponent += 4) {
    svg += fmt::format("<text x='{}' y='{}' text-anchor='middle'>{}</text>",
                       left + cell * (exponent + 12) + 11, bottom, power(exponent));
  }
  svg += fmt::format("<text x='{}' y='{}' text-anchor='middle'>κΔt, optical depth of a step</text></svg>",
                     left + cell * 12.5, height - 4);
  return svg;
}

}  // namespace brace
