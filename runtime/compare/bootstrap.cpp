#include "runtime/compare/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.hpp"
#include "hmd_sim/random.hpp"

namespace brace {

namespace {

/// Reorders `values`. Ranks as nearest_rank() of runtime/metrics has them, without sorting everything.
double statistic_of(std::vector<double>& values, Statistic statistic) {
  if (statistic.percent == 0) {
    double sum = 0;
    for (const double value : values)
      sum += value;
    return sum / static_cast<double>(values.size());
  }
  const double rank = std::ceil(statistic.percent * static_cast<double>(values.size()) / 100.0 - 1e-9);
  const auto place = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(place, values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Fills `to` with blocks of `from` that begin at random places; the last block is cut.
class BlockDraw {
 public:
  BlockDraw(std::size_t count, std::size_t block, std::uint64_t stream) {
    for (std::size_t filled = 0, lane = 0; filled < count; filled += block, ++lane) {
      const double u = sim::uniform01(sim::random_bits(stream, lane));
      begins_.push_back(std::min(static_cast<std::size_t>(u * static_cast<double>(count)), count - 1));
    }
    block_ = block;
  }

  void apply(std::span<const double> from, std::vector<double>& to) const {
    to.clear();
    for (const std::size_t begin : begins_) {
      for (std::size_t i = 0; i < block_ && to.size() < from.size(); ++i)
        to.push_back(from[(begin + i) % from.size()]);
    }
  }

 private:
  std::vector<std::size_t> begins_;
  std::size_t block_ = 1;
};

double interval_end(std::span<const double> ascending, double quantile) {
  const double place = std::floor(quantile * static_cast<double>(ascending.size()));
  return ascending[std::min(static_cast<std::size_t>(place), ascending.size() - 1)];
}

}  // namespace

std::size_t bootstrap_block(std::size_t count) {
  const double root = std::ceil(std::cbrt(static_cast<double>(count)));
  const std::size_t wanted = std::max<std::size_t>(9, static_cast<std::size_t>(root));
  return std::max<std::size_t>(1, std::min(wanted, count / 4));
}

PairedDifference paired_difference(std::span<const double> a, std::span<const double> b, Statistic statistic,
                                   const BootstrapOptions& options) {
  BRACE_CHECK(a.size() == b.size());
  BRACE_CHECK(options.resamples > 0 && options.confidence > 0 && options.confidence < 1);
  PairedDifference result;
  if (a.empty()) return result;
  result.count = a.size();
  result.block = bootstrap_block(a.size());
  std::vector<double> drawn_a(a.begin(), a.end()), drawn_b(b.begin(), b.end());
  result.a = statistic_of(drawn_a, statistic);
  result.b = statistic_of(drawn_b, statistic);
  result.difference = result.b - result.a;

  std::vector<double> differences;
  differences.reserve(static_cast<std::size_t>(options.resamples));
  for (int i = 0; i < options.resamples; ++i) {
    const BlockDraw draw(a.size(), result.block, sim::stream_of(options.seed, static_cast<std::uint64_t>(i)));
    draw.apply(a, drawn_a);
    draw.apply(b, drawn_b);
    differences.push_back(statistic_of(drawn_b, statistic) - statistic_of(drawn_a, statistic));
  }
  std::sort(differences.begin(), differences.end());
  const double tail = (1.0 - options.confidence) / 2.0;
  result.lower = interval_end(differences, tail);
  result.upper = interval_end(differences, 1.0 - tail);
  return result;
}

}  // namespace brace
