#include "hmd_sim/vsync.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace::sim {
namespace {

TEST(Vsync, IsTheExactRationalAfterADayAndAYear) {
  const VsyncClock clock(sim_time(0), {90, 1});
  for (const std::int64_t k : {std::int64_t{0}, std::int64_t{1}, std::int64_t{89}, std::int64_t{90},
                               std::int64_t{90} * 3600 * 24, std::int64_t{90} * 3600 * 24 * 365 + 7}) {
    const std::int64_t whole = k / 90, rest = k % 90;
    EXPECT_EQ(to_ns(clock.time_of(k)), whole * 1'000'000'000 + rest * 1'000'000'000 / 90) << k;
  }
  EXPECT_EQ(to_ns(clock.time_of(90LL * 86400)), 86400LL * 1'000'000'000);
}

TEST(Vsync, DoesNotDriftForHugeIndices) {
  // 10^12 periods at 144 Hz are 220 years.
  const VsyncClock clock(sim_time(0), {144, 1});
  const std::int64_t k = 1'000'000'000'000;
  const long double exact = static_cast<long double>(k) * 1e9L / 144.0L;
  EXPECT_EQ(to_ns(clock.time_of(k)), static_cast<std::int64_t>(std::floor(exact)));
  const SimDuration period = clock.period_after(k);
  EXPECT_TRUE(period == SimDuration(6944444) || period == SimDuration(6944445));
}

TEST(Vsync, RefusesTimesBeyond64Bits) {
  const VsyncClock clock(sim_time(0), {90, 1});
  EXPECT_THROW(clock.time_of(1'000'000'000'000), Error);
}

TEST(Vsync, FirstAtOrAfterIsTheSmallestIndexNotBefore) {
  for (const Rate rate : {Rate{90, 1}, Rate{60000, 1001}, Rate{144, 1}, Rate{1000, 1}, Rate{3, 7}}) {
    const VsyncClock clock(sim_time(-123'456'789), rate);
    for (const std::int64_t base :
         {std::int64_t{-1000}, std::int64_t{0}, std::int64_t{1}, std::int64_t{777'777}}) {
      for (const int offset : {-1, 0, 1}) {
        const SimTime time = clock.time_of(base) + SimDuration(offset);
        const std::int64_t k = clock.first_at_or_after(time);
        EXPECT_GE(clock.time_of(k), time);
        EXPECT_LT(clock.time_of(k - 1), time);
        const std::int64_t before = clock.last_at_or_before(time);
        EXPECT_LE(clock.time_of(before), time);
        EXPECT_GT(clock.time_of(before + 1), time);
      }
    }
  }
}

TEST(Vsync, RefusesARateThatIsNone) {
  EXPECT_THROW(VsyncClock(sim_time(0), {0, 1}), Error);
  EXPECT_THROW(VsyncClock(sim_time(0), {90, 0}), Error);
  EXPECT_THROW(VsyncClock(sim_time(0), {-90, 1}), Error);
  EXPECT_THROW(VsyncClock(sim_time(0), {1'000'000'000, 1'000'000'000}), Error);
}

TEST(ScanOut, RollingRowsAreSpreadOverTheFractionInTheirDirection) {
  const Rate rate{100, 1};  // period 10 ms
  const ScanOut down{ScanDirection::top_to_bottom, 0.8};
  EXPECT_EQ(scan_out_offset(down, rate, 0, 1000), SimDuration(0));
  EXPECT_EQ(scan_out_offset(down, rate, 500, 1000), SimDuration(4'000'000));
  const ScanOut up{ScanDirection::bottom_to_top, 0.8};
  EXPECT_EQ(scan_out_offset(up, rate, 999, 1000), SimDuration(0));
  EXPECT_EQ(scan_out_offset(up, rate, 499, 1000), SimDuration(4'000'000));
  const ScanOut left{ScanDirection::right_to_left, 0.8};
  EXPECT_EQ(scan_out_offset(left, rate, 999, 1000), SimDuration(0));
}

TEST(ScanOut, FractionOfALineIsItsTimeOverThatOfTheLastOne) {
  const Rate rate{100, 1};
  constexpr int lines = 37;
  for (const ScanDirection direction : {ScanDirection::top_to_bottom, ScanDirection::bottom_to_top,
                                        ScanDirection::left_to_right, ScanDirection::right_to_left}) {
    const ScanOut scan{direction, 0.8};
    const bool columns =
        direction == ScanDirection::left_to_right || direction == ScanDirection::right_to_left;
    const ScanFraction fraction = scan_fraction(direction, lines);
    const double whole_ns = static_cast<double>(
        std::max(scan_out_offset(scan, rate, 0, lines), scan_out_offset(scan, rate, lines - 1, lines))
            .count());
    for (int line = 0; line < lines; ++line) {
      const double along = (line + 0.5) / lines;
      const double expected =
          static_cast<double>(scan_out_offset(scan, rate, line, lines).count()) / whole_ns;
      EXPECT_NEAR(fraction.at(columns ? along : 0.3, columns ? 0.3 : along), expected, 1e-6)
          << to_string(direction) << ", line " << line;
    }
  }
  EXPECT_EQ(scan_fraction(ScanDirection::global, lines).at(0.7, 0.9), 0.0);
  EXPECT_EQ(scan_fraction(ScanDirection::top_to_bottom, 1).at(0.7, 0.9), 0.0);
}

TEST(ScanOut, PhotonTimesAddEmissionDelayAndHalfThePersistence) {
  const Rate rate{100, 1};
  const Emission emission{SimDuration(300), SimDuration(2'000'000)};
  const PhotonTimes rolling =
      photon_times(sim_time(5'000), {ScanDirection::top_to_bottom, 0.8}, rate, emission, 1000);
  EXPECT_EQ(to_ns(rolling.first_row), 5'000 + 300 + 1'000'000);
  EXPECT_EQ(to_ns(rolling.mid), 5'000 + 300 + 1'000'000 + 4'000'000);
  EXPECT_EQ(to_ns(rolling.last_row), 5'000 + 300 + 1'000'000 + 7'992'000);
  const PhotonTimes global =
      photon_times(sim_time(5'000), {ScanDirection::global, 0.8}, rate, emission, 1000);
  EXPECT_EQ(global.first_row, global.last_row);
  EXPECT_EQ(to_ns(global.mid), 5'000 + 300 + 1'000'000 + 8'000'000);
}

}  // namespace
}  // namespace brace::sim
