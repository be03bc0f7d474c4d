#include "tools/live/frame_history.hpp"

#include <gtest/gtest.h>

namespace brace {
namespace {

LiveFrame frame_at(double shown_s, double interval_ms, std::int64_t missed = 0) {
  LiveFrame frame;
  frame.shown = SimTime(from_s(shown_s));
  frame.interval_ms = interval_ms;
  frame.missed = missed;
  return frame;
}

TEST(MillisecondCounts, HaveTheNearestRanksOfTheTimesToABin) {
  std::vector<double> times;
  MillisecondCounts counts;
  for (int i = 0; i < 1000; ++i) {
    times.push_back(11.0 + 0.0137 * ((i * 377) % 1000));
    counts.add(times.back());
  }
  times.push_back(5000.0);  // longer than the longest bin
  counts.add(times.back());
  const Distribution exact = distribution_of(times), counted = counts.distribution();
  EXPECT_EQ(counted.count, exact.count);
  EXPECT_NEAR(counted.mean, exact.mean, 1e-9);
  EXPECT_NEAR(counted.p50, exact.p50, 0.01);
  EXPECT_NEAR(counted.p95, exact.p95, 0.01);
  EXPECT_NEAR(counted.p99, exact.p99, 0.01);
  EXPECT_DOUBLE_EQ(counted.max, 5000.0);
  EXPECT_EQ(MillisecondCounts().distribution().count, 0);
}

TEST(FrameHistory, KeepsTheLastSecondsAloneWhateverTheRate) {
  for (const double rate_hz : {5.0, 90.0, 700.0}) {
    FrameHistory history;
    for (int i = 0; i < static_cast<int>(10.0 * rate_hz); ++i)
      history.add(frame_at(i / rate_hz, 1e3 / rate_hz));
    EXPECT_NEAR(static_cast<double>(history.recent().size()), FrameHistory::kept_s * rate_hz, 1.5);
    EXPECT_NEAR(history.rate_hz(), rate_hz, 1e-3 * rate_hz);
  }
}

TEST(FrameHistory, LeavesTheFirstSecondOutOfTheTotals) {
  FrameHistory history;
  history.add(frame_at(0.0, 0.0));
  history.add(frame_at(0.9, 900.0, 80));  // kernels were compiled
  for (int i = 0; i < 99; ++i)
    history.add(frame_at(1.0 + 0.01 * i, 10.0));
  history.add(frame_at(2.5, 30.0, 2));
  const FrameHistory::Totals totals = history.totals();
  EXPECT_EQ(history.pictures(), 102);
  EXPECT_EQ(totals.pictures, 100);
  EXPECT_EQ(totals.missed, 2);
  EXPECT_NEAR(totals.missed_ratio(), 2.0 / 102.0, 1e-12);
  EXPECT_NEAR(totals.interval_ms.p99, 10.0, 0.01);
  EXPECT_DOUBLE_EQ(totals.interval_ms.max, 30.0);
}

TEST(FrameHistory, HasNoRateFromASinglePicture) {
  FrameHistory history;
  EXPECT_EQ(history.rate_hz(), 0.0);
  history.add(frame_at(0.0, 0.0));
  EXPECT_EQ(history.rate_hz(), 0.0);
  EXPECT_EQ(history.totals().pictures, 0);
  EXPECT_EQ(history.totals().missed_ratio(), 0.0);
}

}  // namespace
}  // namespace brace
