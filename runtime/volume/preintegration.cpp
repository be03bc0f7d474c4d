#include "runtime/volume/preintegration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"

namespace brace {

namespace {

using Sums = std::array<double, 4>;

double step_depth(const std::array<double, 4>& entry, double step_units) {
  return std::min(entry[3] * step_units * std::numbers::log2e, integral_depth_max);
}

/// Integrals over the part [0, place] between two entries: w and c are linear, so their product is a
/// parabola.
Sums integral_between(const std::array<double, 4>& low, const std::array<double, 4>& high, double step_units,
                      double place) {
  const double w = step_depth(low, step_units);
  const double dw = step_depth(high, step_units) - w;
  Sums sums{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double dc = high[c] - low[c];
    sums[c] = place * (w * low[c] + place * ((w * dc + dw * low[c]) / 2 + place * dw * dc / 3));
  }
  sums[3] = place * (w + place * dw / 2);
  return sums;
}

Sums sum(Sums a, const Sums& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] += b[i];
  return a;
}

/// A step as a row of pieces, each with its own mean depth and mean colour.
std::array<float, 4> segment(const TransferIntegrals& integrals, const TransferTable& table,
                             double step_units, double front, double back) {
  constexpr int pieces_max = 32;
  const int pieces = std::clamp(static_cast<int>(std::ceil(std::abs(back - front))), 2, pieces_max);
  std::array<double, 3> colour{};
  double depth = 0;
  Sums before = integral_up_to(integrals, table, step_units, front);
  for (int piece = 1; piece <= pieces; ++piece) {
    const double u = std::lerp(front, back, static_cast<double>(piece) / pieces);
    const Sums here = integral_up_to(integrals, table, step_units, u);
    double w = std::abs(here[3] - before[3]);
    std::array<double, 3> mean{};
    if (w > 0) {
      for (std::size_t c = 0; c < 3; ++c)
        mean[c] = std::clamp((here[c] - before[c]) / (here[3] - before[3]), 0.0, 1.0);
      w /= std::abs(back - front);
    } else if (front == back) {
      const TransferSample sample =
          lookup(table, table.range.min + (table.range.max - table.range.min) * u /
                                              static_cast<double>(table.entries.size() - 1));
      mean = {sample.r, sample.g, sample.b};
      w = std::min(sample.kappa * step_units * std::numbers::log2e, integral_depth_max) / pieces;
    }
    const double added = std::exp2(-depth) * -std::expm1(-w * std::numbers::ln2);
    for (std::size_t c = 0; c < 3; ++c)
      colour[c] += added * mean[c];
    depth += w;
    before = here;
  }
  const double opacity = -std::expm1(-depth * std::numbers::ln2);
  return {static_cast<float>(colour[0]), static_cast<float>(colour[1]), static_cast<float>(colour[2]),
          static_cast<float>(opacity)};
}

}  // namespace

TransferIntegrals integrate(const TransferTable& table, double step_units) {
  BRACE_CHECK(step_units > 0 && table.entries.size() >= 2);
  TransferIntegrals integrals(table.entries.size(), Sums{});
  for (std::size_t i = 1; i < integrals.size(); ++i)
    integrals[i] =
        sum(integrals[i - 1], integral_between(table.entries[i - 1], table.entries[i], step_units, 1.0));
  return integrals;
}

std::array<double, 4> integral_up_to(const TransferIntegrals& integrals, const TransferTable& table,
                                     double step_units, double coordinate) {
  const double last = static_cast<double>(integrals.size() - 1);
  const double u = std::clamp(coordinate, 0.0, last);
  const auto i = static_cast<std::size_t>(std::min(std::floor(u), last - 1));
  return sum(integrals[i], integral_between(table.entries[i], table.entries[i + 1], step_units,
                                            u - static_cast<double>(i)));
}

int segment_table_size(const TransferTable& table) {
  constexpr std::size_t exact_max = 256;
  constexpr int coarse = 128;
  return table.entries.size() <= exact_max ? static_cast<int>(table.entries.size()) : coarse;
}

std::vector<std::array<float, 4>> preintegrated_segments(const TransferTable& table,
                                                         const TransferIntegrals& integrals,
                                                         double step_units, int size) {
  BRACE_CHECK(size >= 2 && integrals.size() == table.entries.size());
  const double entries_per_node = static_cast<double>(table.entries.size() - 1) / (size - 1);
  std::vector<std::array<float, 4>> segments;
  segments.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int back = 0; back < size; ++back)
    for (int front = 0; front < size; ++front)
      segments.push_back(
          segment(integrals, table, step_units, front * entries_per_node, back * entries_per_node));
  return segments;
}

}  // namespace brace
