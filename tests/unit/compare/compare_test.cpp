#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "hmd_sim/random.hpp"
#include "runtime/compare/compare_records.hpp"

namespace brace {
namespace {

std::vector<double> noise(std::size_t count, std::uint64_t seed) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(sim::near_normal(sim::random_bits(sim::stream_of(seed, 0), i)));
  return values;
}

TEST(Bootstrap, ANoiseThatBothSharePairsOutExactly) {
  const std::vector<double> a = noise(200, 1);
  std::vector<double> b = a;
  for (double& value : b)
    value += 0.25;
  const PairedDifference d = paired_difference(a, b, {0}, {});
  EXPECT_NEAR(d.difference, 0.25, 1e-12);
  EXPECT_NEAR(d.upper - d.lower, 0, 1e-12);
  const PairedDifference tail = paired_difference(a, b, {99}, {});
  EXPECT_NEAR(tail.difference, 0.25, 1e-12);
}

TEST(Bootstrap, TheIntervalHasTheWidthOfTheFormulaForIndependentValues) {
  // Difference of two independent unit normals over n pairs: standard error sqrt(2 / n), 95 % is +-1.96 of
  // it.
  const std::size_t count = 900;
  const PairedDifference d = paired_difference(noise(count, 1), noise(count, 2), {0}, {});
  const double wanted = 2 * 1.96 * std::sqrt(2.0 / static_cast<double>(count));
  EXPECT_GT(d.upper - d.lower, 0.7 * wanted);
  EXPECT_LT(d.upper - d.lower, 1.3 * wanted);
}

TEST(Bootstrap, FewValuesHaveShortBlocks) {
  EXPECT_EQ(bootstrap_block(1), 1U);
  EXPECT_EQ(bootstrap_block(8), 2U);
  EXPECT_EQ(bootstrap_block(900), 10U);
  EXPECT_EQ(paired_difference({}, {}, {0}, {}).count, 0U);
}

std::vector<FrameRecord> records(double age_ms, const std::vector<double>& noise_ms) {
  std::vector<FrameRecord> all(noise_ms.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].vsync_index = static_cast<std::int64_t>(i);
    all[i].vsync_ns = all[i].vsync_index * 11'111'111;
    all[i].displayed_frame = all[i].vsync_index;
    all[i].frame_age_ns = static_cast<std::int64_t>(std::llround((age_ms + noise_ms[i]) * 1e6));
  }
  return all;
}

Verdict age_verdict(const RecordsComparison& comparison) {
  for (const FigureComparison& figure : comparison.figures) {
    if (figure.figure == "frame_age_ms" && figure.statistic == "mean") return figure.verdict;
  }
  throw std::runtime_error("no frame_age_ms");
}

TEST(CompareRecords, MeasuredRunsFailOnlyWhereTheIntervalIsBeyondTheTolerance) {
  const auto a = records(20, noise(100, 1));
  const auto slightly = records(20.3, noise(100, 3)), far = records(23, noise(100, 3));
  CompareOptions options;
  options.tolerances = {parse_tolerance("frame_age_ms=0.2")};
  EXPECT_EQ(age_verdict(compare_records(a, slightly, true, options)), Verdict::worse);
  EXPECT_EQ(age_verdict(compare_records(a, slightly, false, options)), Verdict::unclear);
  EXPECT_EQ(age_verdict(compare_records(a, far, false, options)), Verdict::worse);
  EXPECT_EQ(age_verdict(compare_records(far, a, false, options)), Verdict::better);
  options.tolerances = {parse_tolerance("frame_age_ms=50%")};
  EXPECT_EQ(age_verdict(compare_records(a, far, true, options)), Verdict::same);
}

TEST(CompareRecords, ARunThatNeverShowsAnythingMissesEverything) {
  const auto a = records(20, noise(20, 1));
  auto b = a;
  for (FrameRecord& record : b)
    record.displayed_frame = record.frame_age_ns = -1;
  const RecordsComparison comparison = compare_records(a, b, true, {});
  ASSERT_EQ(comparison.figures.front().figure, "missed_ratio");
  EXPECT_EQ(comparison.figures.front().pairs.b, 1.0);
  EXPECT_EQ(comparison.figures.front().verdict, Verdict::worse);
}

TEST(CompareRecords, OtherVsyncsAreRefused) {
  const auto a = records(20, noise(20, 1));
  auto b = a;
  b.back().vsync_ns += 1;
  EXPECT_THROW(compare_records(a, b, true, {}), Error);
  EXPECT_THROW(compare_records(a, {}, true, {}), Error);
}

}  // namespace
}  // namespace brace
