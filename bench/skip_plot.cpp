#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "base/error.hpp"
#include "bench/skip.hpp"

namespace brace {

namespace {

/// A bar chart with groups of bars and a logarithmic axis, in the report's colours.
struct Bar {
  double value = 0;
  double lighter = 0;  // a second value, drawn behind in a lighter shade; 0: none
  std::size_t series = 0;
};
struct Group {
  std::string label;
  std::vector<Bar> bars;
};
struct BarChart {
  std::string title, unit;
  std::vector<std::string> series;
  std::vector<Group> groups;
};

constexpr const char* colours[] = {"#7f8c99", "#6aaed6", "#0072b2", "#e69f00",
                                   "#d55e00", "#aa3377", "#117733", "#88ccaa"};
constexpr double bar_px = 9, gap_px = 14, left_px = 62, top_px = 64, plot_px = 260, label_px = 34;

std::pair<double, double> decades(const BarChart& chart) {
  double least = 1e30, most = 1e-30;
  for (const Group& group : chart.groups)
    for (const Bar& bar : group.bars) {
      if (bar.value > 0) least = std::min(least, bar.value);
      most = std::max({most, bar.value, bar.lighter});
    }
  if (least > most) return {0.0, 1.0};
  return {std::floor(std::log10(least)),
          std::max(std::ceil(std::log10(most)), std::floor(std::log10(least)) + 1)};
}

std::string to_svg(const BarChart& chart) {
  const auto [low, high] = decades(chart);
  const double bottom = top_px + plot_px;
  const auto y_of = [low = low, high = high, bottom](double value) {
    return bottom - std::clamp((std::log10(value) - low) / (high - low), 0.0, 1.0) * plot_px;
  };
  std::string body;
  double x = left_px + gap_px / 2;
  const auto rect = [&](double value, double opacity, std::size_t series) {
    if (!(value > 0)) return;
    body +=
        fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{}' height='{:.1f}' fill='{}' fill-opacity='{}'/>\n",
                    x, y_of(value), bar_px - 1, std::max(bottom - y_of(value), 1.0),
                    colours[series % std::size(colours)], opacity);
  };
  for (const Group& group : chart.groups) {
    const double begin = x;
    for (const Bar& bar : group.bars) {
      rect(bar.lighter, 0.35, bar.series);
      rect(bar.value, 1.0, bar.series);
      x += bar_px;
    }
    body += fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>{}</text>\n", (begin + x) / 2,
                        bottom + 15, group.label);
    x += gap_px;
  }
  std::string axis;
  for (double power = low; power <= high; ++power)
    axis += fmt::format(
        "<path d='M{0} {1:.1f}H{2:.1f}' stroke='#d8dde3'/><text x='{3}' y='{4:.1f}' text-anchor='end'>{5:g} "
        "{6}</text>\n",
        left_px, y_of(std::pow(10.0, power)), x, left_px - 6, y_of(std::pow(10.0, power)) + 4,
        std::pow(10.0, power), chart.unit);
  std::string legend;
  double at = left_px;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    legend += fmt::format(
        "<rect x='{:.0f}' y='34' width='11' height='11' fill='{}'/><text x='{:.0f}' y='44'>{}"
        "</text>\n",
        at, colours[i % std::size(colours)], at + 15, chart.series[i]);
    at += 28 + 6.4 * static_cast<double>(chart.series[i].size());
  }
  const double width = std::max(x, at) + 10, height = bottom + label_px;
  return fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' font-family='sans-serif' "
      "font-size='11' fill='#26323d'>\n<rect width='{0:.0f}' height='{1:.0f}' fill='white'/>\n<text x='{2}' "
      "y='20' "
      "font-size='14'>{3}</text>\n{4}{5}{6}</svg>\n",
      width, height, left_px, chart.title, legend, axis, body);
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw input_error("{}: cannot be written (accepted: a writable folder)", path.string());
}

}  // namespace

std::string updates_svg(const SkipBenchResult& result) {
  BarChart chart{
      "Update at a change of the transfer function (64 partitions), device time",
      "ms",
      {"as published", "bitmask", "distance_map", "paper's merge", "one-pass merge", "segment tree"},
      {}};
  for (const SkipUpdateRow& row : result.updates) {
    Group group{fmt::format("{} TF{}", row.scene, row.tf),
                {{row.published_ms, 0, 0}, {row.bitmask_ms, 0, 1}, {row.recomputed_ms, 0, 2}}};
    for (const auto& merge : row.merges) {
      if (merge.partitions != 64) continue;
      group.bars.push_back({merge.paper_ms, 0, 3});
      group.bars.push_back({merge.merge_ms, 0, 4});
      group.bars.push_back({merge.tree_ms, 0, 5});
    }
    chart.groups.push_back(std::move(group));
  }
  return to_svg(chart);
}

std::string frames_svg(const SkipBenchResult& result) {
  BarChart chart{
      "Frames (Figs. 4 and 5): with early termination, and to the end of the ray (lighter)", "ms", {}, {}};
  std::map<std::string, std::size_t> group_of;
  for (const SkipFrameRow& row : result.frames) {
    auto found = std::find(chart.series.begin(), chart.series.end(), row.stage);
    if (found == chart.series.end()) found = chart.series.insert(found, row.stage);
    const auto series = static_cast<std::size_t>(found - chart.series.begin());
    const std::string label = row.tf == 0 ? row.scene.substr(0, 8) + " 1 %"
                                          : fmt::format("{} TF{}", row.scene.substr(0, 8), row.tf);
    const auto [at, is_new] = group_of.emplace(label, chart.groups.size());
    if (is_new) chart.groups.push_back({label, {}});
    chart.groups[at->second].bars.push_back({row.ms, row.ms_without_termination, series});
  }
  return to_svg(chart);
}

void write_skip_bench(const SkipBenchResult& result, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  write_file(folder / "skip.txt", to_text(result));
  write_file(folder / "skip.json", to_json(result));
  if (!result.updates.empty()) write_file(folder / "updates.svg", updates_svg(result));
  if (!result.frames.empty()) write_file(folder / "frames.svg", frames_svg(result));
}

}  // namespace brace
