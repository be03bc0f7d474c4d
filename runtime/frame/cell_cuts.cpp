#include "runtime/frame/cell_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/error.hpp"

namespace brace {

namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

std::span<const double> part(const std::vector<double>& values, int band, int columns) {
  return std::span(values).subspan(at(band * (columns + 1)), at(columns + 1));
}

/// The value at x of the line through (edges, values), the edges rising and x within them.
double interpolate(std::span<const double> edges, std::span<const double> values, double x) {
  const auto after = std::upper_bound(edges.begin(), edges.end(), x);
  const auto i = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(after - edges.begin(), 1, static_cast<std::ptrdiff_t>(edges.size()) - 1));
  const double width = edges[i] - edges[i - 1];
  const double t = width > 0.0 ? std::clamp((x - edges[i - 1]) / width, 0.0, 1.0) : 1.0;
  return values[i - 1] + t * (values[i] - values[i - 1]);
}

/// Where a rising function of 0 … 1 passes `value`, to a four billionth.
template <class Function>
double where(double value, const Function& function) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 32; ++i) {
    const double middle = 0.5 * (low + high);
    (function(middle) < value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void make_even(CellCuts& cuts) {
  for (int band = 0; band <= cuts.rows; ++band)
    cuts.bands[at(band)] = static_cast<double>(band) / cuts.rows;
  for (int i = 0; i < cuts.rows * (cuts.columns + 1); ++i)
    cuts.columns_in_band[at(i)] = static_cast<double>(i % (cuts.columns + 1)) / cuts.columns;
}

}  // namespace

CellCuts::CellCuts(int columns_across, int rows_down)
    : columns(columns_across),
      rows(rows_down),
      bands(at(rows_down + 1)),
      columns_in_band(at(rows_down * (columns_across + 1))) {
  BRACE_CHECK(columns > 0 && rows > 0);
  make_even(*this);
}

CellCuts::Area CellCuts::area(int cell) const {
  const int band = cell / columns, column = cell % columns;
  const std::span<const double> edges = part(columns_in_band, band, columns);
  return {edges[at(column)], bands[at(band)], edges[at(column + 1)], bands[at(band + 1)]};
}

CostDensity::CostDensity(int columns, int rows)
    : cuts_(columns, rows), above_band_(at(rows + 1)), left_of_edge_(at(rows * (columns + 1))) {}

void CostDensity::set(const CellCuts& cuts, std::span<const double> costs, double even_share) {
  BRACE_CHECK(cuts.columns == cuts_.columns && cuts.rows == cuts_.rows &&
              costs.size() == at(cuts.columns * cuts.rows));
  cuts_ = cuts;  // of the same size: no allocation
  for (int band = 0; band < cuts.rows; ++band) {
    double sum = 0.0;
    for (int column = 0; column < cuts.columns; ++column) {
      left_of_edge_[at(band * (cuts.columns + 1) + column)] = sum;
      sum += costs[at(band * cuts.columns + column)];
    }
    left_of_edge_[at(band * (cuts.columns + 1) + cuts.columns)] = sum;
    above_band_[at(band + 1)] = above_band_[at(band)] + sum;
  }
  even_ = even_share * above_band_.back();
}

double CostDensity::above(double y) const {
  return even_ * y + interpolate(cuts_.bands, above_band_, y);
}

double CostDensity::left_of(double top, double bottom, double x) const {
  double sum = even_ * (bottom - top) * x;
  const auto first = std::upper_bound(cuts_.bands.begin(), cuts_.bands.end(), top) - cuts_.bands.begin() - 1;
  for (int band = std::max(static_cast<int>(first), 0); band < cuts_.rows; ++band) {
    const double low = cuts_.bands[at(band)], high = cuts_.bands[at(band + 1)];
    if (low >= bottom) break;
    if (high <= low) continue;
    const double share = (std::min(bottom, high) - std::max(top, low)) / (high - low);
    if (share > 0.0)
      sum += share * interpolate(part(cuts_.columns_in_band, band, cuts_.columns),
                                 part(left_of_edge_, band, cuts_.columns), x);
  }
  return sum;
}

double CostDensity::in(const CellCuts::Area& area) const {
  return std::max(left_of(area.top, area.bottom, area.right) - left_of(area.top, area.bottom, area.left),
                  0.0);
}

void cut_by_cost(const CostDensity& costs, CellCuts& into) {
  const double all = costs.sum();
  if (!(all > 0.0) || !std::isfinite(all)) {
    make_even(into);
    return;
  }
  for (int band = 1; band < into.rows; ++band)
    into.bands[at(band)] = where(all * band / into.rows, [&](double y) { return costs.above(y); });
  for (int band = 0; band < into.rows; ++band) {
    const double top = into.bands[at(band)], bottom = into.bands[at(band + 1)];
    const auto left_of = [&](double x) { return costs.left_of(top, bottom, x); };
    const double in_band = left_of(1.0);
    for (int column = 1; column < into.columns; ++column)
      into.columns_in_band[at(band * (into.columns + 1) + column)] =
          where(in_band * column / into.columns, left_of);
  }
}

}  // namespace brace
