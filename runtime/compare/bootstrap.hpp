#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace brace {

/// What is compared of the two sides: their means, or a nearest-rank percentile of each.
struct Statistic {
  double percent = 0;  // 0: the mean; else 0 < percent <= 100
};

struct BootstrapOptions {
  std::uint64_t seed = 1;
  int resamples = 1000;      // > 0
  double confidence = 0.95;  // 0 < confidence < 1
};

/// statistic(b) - statistic(a) and its interval. All zero without values.
struct PairedDifference {
  std::size_t count = 0;
  std::size_t block = 0;  // values per block
  double a = 0, b = 0;    // the statistic of each side
  double difference = 0;
  double lower = 0, upper = 0;
};

/// Block length for `count` successive vsyncs: 0.1 s at 90 Hz or count^(1/3), whichever is longer, but at
/// most a quarter of the values. Errors of neighbouring vsyncs depend on one another (a stale frame, a head
/// turn), so single vsyncs must not be drawn on their own.
std::size_t bootstrap_block(std::size_t count);

/// Circular block bootstrap (Politis and Romano 1992) of pairs: a[i] and b[i] belong together and are drawn
/// together, so what both runs share cancels out. Percentile interval. `a` and `b` are equally long, finite
/// and in the order of time. Deterministic: a function of values and options.
PairedDifference paired_difference(std::span<const double> a, std::span<const double> b, Statistic statistic,
                                   const BootstrapOptions& options);

}  // namespace brace
