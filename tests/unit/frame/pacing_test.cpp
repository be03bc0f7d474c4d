#include "runtime/metrics/pacing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace brace {
namespace {

constexpr std::int64_t period_ns = 10'000'000;

/// A vsync that shows `frame`, rendered for the vsync where it is first seen.
FrameRecord shown(std::int64_t vsync, std::int64_t frame, bool missed, std::int32_t stale_run) {
  FrameRecord r;
  r.vsync_index = vsync;
  r.vsync_ns = vsync * period_ns;
  r.photon_mid_ns = r.vsync_ns + 5'000'000;
  r.displayed_frame = frame;
  r.missed = missed;
  r.stale_run = stale_run;
  r.mtp_rotation_ns = 8'000'000;
  r.mtp_translation_ns = 20'000'000;
  r.frame_age_ns = 15'000'000;
  r.angular_error_rad = 0;
  r.position_error_m = 0;
  r.angular_error_vector_rad = {0, 0, 0};
  r.render_target_ns = r.photon_mid_ns;
  return r;
}

FrameRecord startup(std::int64_t vsync) {
  FrameRecord r;
  r.vsync_index = vsync;
  return r;
}

TEST(Percentiles, NearestRankIsTheSmallestValueWithEnoughBelow) {
  std::vector<double> hundred(100);
  std::iota(hundred.begin(), hundred.end(), 1.0);
  EXPECT_EQ(nearest_rank(hundred, 50), 50);
  EXPECT_EQ(nearest_rank(hundred, 95), 95);
  EXPECT_EQ(nearest_rank(hundred, 99), 99);
  EXPECT_EQ(nearest_rank(hundred, 100), 100);
  const std::vector<double> five{15, 20, 35, 40, 50};  // the textbook's example
  EXPECT_EQ(nearest_rank(five, 5), 15);
  EXPECT_EQ(nearest_rank(five, 30), 20);
  EXPECT_EQ(nearest_rank(five, 40), 20);
  EXPECT_EQ(nearest_rank(five, 50), 35);
  EXPECT_EQ(nearest_rank(five, 100), 50);
  EXPECT_EQ(nearest_rank(std::vector<double>{7}, 1), 7);
}

TEST(Percentiles, EqualTheDefinitionOnRandomData) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 100; ++round) {
    std::vector<double> values(1 + random() % 300);
    for (double& value : values)
      value = static_cast<double>(random() % 50);
    const Distribution d = distribution_of(values);
    for (const auto& [percent, value] : {std::pair{50.0, d.p50}, {95.0, d.p95}, {99.0, d.p99}}) {
      const auto at_or_below = [&](double limit) {
        return static_cast<double>(
            std::count_if(values.begin(), values.end(), [&](double v) { return v <= limit; }));
      };
      ASSERT_GE(at_or_below(value) * 100, percent * static_cast<double>(values.size()));
      ASSERT_LT(at_or_below(std::nextafter(value, -1)) * 100, percent * static_cast<double>(values.size()));
    }
    ASSERT_EQ(d.max, *std::max_element(values.begin(), values.end()));
  }
  EXPECT_EQ(distribution_of({}).count, 0);
}

TEST(Pacing, CountsMissesStaleRunsStartUpAndGaps) {
  std::vector<FrameRecord> records{startup(0), startup(1)};
  records.push_back(shown(2, 0, false, 0));
  records.push_back(shown(3, 0, true, 1));
  records.push_back(shown(4, 0, true, 2));
  records.push_back(shown(5, 1, false, 0));
  records.push_back(shown(6, 1, true, 1));
  records.back().pose_valid = false;
  records.push_back(shown(7, 2, false, 0));
  const PacingFigures f = pacing_figures(records);
  EXPECT_EQ(f.vsyncs, 8);
  EXPECT_EQ(f.startup_vsyncs, 2);
  EXPECT_EQ(f.gap_vsyncs, 1);
  EXPECT_EQ(f.missed_vsyncs, 3);
  EXPECT_DOUBLE_EQ(f.missed_ratio, 3.0 / 6);
  EXPECT_EQ(f.stale_runs, 2);
  EXPECT_EQ(f.longest_stale_run, 2);
  EXPECT_EQ(f.frames_shown, 3);
  EXPECT_EQ(f.mtp_rotation_ms.count, 5) << "the gap's latency is not known";
  EXPECT_DOUBLE_EQ(f.mtp_rotation_ms.p99, 8);
  EXPECT_DOUBLE_EQ(f.mtp_translation_ms.mean, 20);
  EXPECT_DOUBLE_EQ(f.frame_age_ms.max, 15);
}

TEST(Pacing, NoRecordsGiveNoFiguresAndNoDivisionByZero) {
  const PacingFigures none = pacing_figures({});
  EXPECT_EQ(none.vsyncs, 0);
  EXPECT_EQ(none.missed_ratio, 0);
  const PacingFigures only_startup = pacing_figures(std::vector<FrameRecord>{startup(0)});
  EXPECT_EQ(only_startup.missed_ratio, 0);
  EXPECT_EQ(only_startup.judder_rms_deg, 0);
}

TEST(Pacing, AnimationErrorIsTheDriftBetweenPredictedAndSeenAndBlindToCleanDrops) {
  std::vector<FrameRecord> records{shown(0, 0, false, 0), shown(1, 1, false, 0), shown(4, 2, false, 0)};
  EXPECT_EQ(pacing_figures(records).animation_error_ms.max, 0) << "a clean drop of two vsyncs";
  records[1].render_target_ns -= 2'500'000;  // predicted for 2.5 ms before it was seen
  const Distribution error = pacing_figures(records).animation_error_ms;
  EXPECT_EQ(error.count, 2);
  EXPECT_DOUBLE_EQ(error.p50, 2.5);
  EXPECT_DOUBLE_EQ(error.max, 2.5);
}

TEST(Pacing, JudderIsTheRmsOfTheSecondDifferenceAndZeroForASteadyDrift) {
  const double rad = std::numbers::pi / 180;
  std::vector<FrameRecord> records;
  for (int k = 0; k < 20; ++k) {
    records.push_back(shown(k, k, false, 0));
    records.back().angular_error_vector_rad = {0.5 * k * rad, -0.25 * k * rad,
                                               9 * rad};  // linear; roll ignored
    records.back().angular_error_rad = 1;
  }
  EXPECT_NEAR(pacing_figures(records).judder_rms_deg, 0, 1e-12);
  for (int k = 0; k < 20; ++k) {
    const double wobble = k % 2 == 0 ? 0.1 : -0.1;  // second difference: 0.4 degrees in size, always
    records[static_cast<std::size_t>(k)].angular_error_vector_rad = {0, wobble * rad, 0};
  }
  EXPECT_NEAR(pacing_figures(records).judder_rms_deg, 0.4, 1e-12);
  for (FrameRecord& r : records)
    r.angular_error_vector_rad[0] = r.angular_error_vector_rad[1];
  EXPECT_NEAR(pacing_figures(records).judder_rms_deg, 0.4 * std::sqrt(2.0), 1e-12);
  // Every third vsync in a gap: never three successive ones.
  for (std::size_t k = 0; k < records.size(); k += 3)
    records[k].pose_valid = false;
  EXPECT_EQ(pacing_figures(records).judder_rms_deg, 0);
}

TEST(Pacing, FrameRateOfASteadyRunIsThatRate) {
  std::vector<std::int64_t> done;
  for (int i = 0; i < 500; ++i)
    done.push_back(7 + i * 20'000'000LL);
  const FrameRate rate = frame_rate(done);
  EXPECT_EQ(rate.frames, 500);
  EXPECT_DOUBLE_EQ(rate.fps_avg, 50);
  EXPECT_DOUBLE_EQ(rate.fps_1pct_low, 50);
  EXPECT_DOUBLE_EQ(rate.fps_1pct_low_mean, 50);
}

TEST(Pacing, TheTwoOnePercentLowsDifferAsDefined) {
  // 1000 frame times: 980 of 10 ms, 15 of 20 ms, 5 of 100 ms.
  std::vector<std::int64_t> done{0};
  for (int i = 0; i < 1000; ++i)
    done.push_back(done.back() + (i < 980 ? 10'000'000 : i < 995 ? 20'000'000 : 100'000'000));
  const FrameRate rate = frame_rate(done);
  EXPECT_DOUBLE_EQ(rate.fps_1pct_low, 50) << "p99: the 990th of 1000, 20 ms";
  EXPECT_DOUBLE_EQ(rate.fps_1pct_low_mean, 1000.0 / 60) << "mean of the slowest ten: 60 ms";
  EXPECT_NEAR(rate.fps_avg, 1000 / 10.6, 1e-9);
}

TEST(Pacing, FewerThanTwoFramesHaveNoRate) {
  EXPECT_EQ(frame_rate({}).fps_avg, 0);
  EXPECT_EQ(frame_rate(std::vector<std::int64_t>{5}).fps_1pct_low, 0);
  EXPECT_EQ(frame_rate(std::vector<std::int64_t>{5, 5}).fps_avg, 0);
}

TEST(Pacing, HistogramsAreWithinTheirStatedErrorFromNanosToDays) {
  std::mt19937_64 random(4);
  std::lognormal_distribution<double> wide(0, 5);
  HistogramValues histogram;
  ExactValues exact;
  for (int i = 0; i < 20'000; ++i) {
    const double value = i % 100 == 0 ? 0.0 : wide(random);
    histogram.add(value);
    exact.add(value);
  }
  const Distribution h = histogram.distribution(), e = exact.distribution();
  EXPECT_EQ(h.count, e.count);
  EXPECT_EQ(h.max, e.max);
  EXPECT_NEAR(h.p50, e.p50, 5e-4 * e.p50);
  EXPECT_NEAR(h.p95, e.p95, 5e-4 * e.p95);
  EXPECT_NEAR(h.p99, e.p99, 5e-4 * e.p99);
  EXPECT_NEAR(histogram.mean_of_largest(1), exact.mean_of_largest(1), 5e-4 * exact.mean_of_largest(1));
}

}  // namespace
}  // namespace brace
