#include "runtime/volume/preintegration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ranges>
#include <span>

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

/// A piece of a step with a mean depth and a mean colour of its own.
struct Piece {
  double taken;  // share of the light that it takes away, 1 - 2^-depth
  double depth;
  std::array<double, 3> colour;
};

constexpr int pieces_max = 32;

/// A step whose coordinate stays where it is.
Piece still_piece(const TransferTable& table, double step_units, double u) {
  const double range = table.range.max - table.range.min;
  const TransferSample sample =
      lookup(table, table.range.min + range * u / static_cast<double>(table.entries.size() - 1));
  const double depth = std::min(sample.kappa * step_units * std::numbers::log2e, integral_depth_max);
  return {-std::expm1(-depth * std::numbers::ln2), depth, {sample.r, sample.g, sample.b}};
}

/// The pieces of a step from low to high, which are also those of the step back.
std::size_t cut(const TransferIntegrals& integrals, const TransferTable& table, double step_units, double low,
                double high, std::array<Piece, pieces_max>& pieces) {
  if (low == high) {
    pieces[0] = still_piece(table, step_units, low);
    return 1;
  }
  const int count = std::clamp(static_cast<int>(std::ceil(high - low)), 2, pieces_max);
  Sums before = integral_up_to(integrals, table, step_units, low);
  for (int i = 0; i < count; ++i) {
    const double u = std::lerp(low, high, static_cast<double>(i + 1) / count);
    const Sums here = integral_up_to(integrals, table, step_units, u);
    const double mass = here[3] - before[3];
    Piece& piece = pieces[static_cast<std::size_t>(i)];
    piece = {0.0, std::abs(mass) / (high - low), {}};
    if (piece.depth > 0) {
      piece.taken = -std::expm1(-piece.depth * std::numbers::ln2);
      for (std::size_t c = 0; c < 3; ++c)
        piece.colour[c] = std::clamp((here[c] - before[c]) / mass, 0.0, 1.0);
    }
    before = here;
  }
  return static_cast<std::size_t>(count);
}

/// What a row of pieces adds up to, the first of them in front.
template <typename Pieces>
std::array<float, 4> through(const Pieces& pieces) {
  std::array<double, 3> colour{};
  double depth = 0;
  double transmittance = 1;
  for (const Piece& piece : pieces) {
    const double added = transmittance * piece.taken;
    for (std::size_t c = 0; c < 3; ++c)
      colour[c] += added * piece.colour[c];
    transmittance -= added;
    depth += piece.depth;
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
  const auto edge = static_cast<std::size_t>(size);
  std::vector<std::array<float, 4>> segments(edge * edge);
  std::array<Piece, pieces_max> pieces;
  for (std::size_t high = 0; high < edge; ++high)
    for (std::size_t low = 0; low <= high; ++low) {
      const std::size_t count = cut(integrals, table, step_units, static_cast<double>(low) * entries_per_node,
                                    static_cast<double>(high) * entries_per_node, pieces);
      const std::span row(pieces.data(), count);
      segments[high * edge + low] = through(row);
      segments[low * edge + high] = through(std::views::reverse(row));
    }
  return segments;
}

}  // namespace brace
