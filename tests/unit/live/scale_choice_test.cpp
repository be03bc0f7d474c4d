#include "tools/live/scale_choice.hpp"

#include <gtest/gtest.h>

namespace brace {
namespace {

/// Eyes of so many milliseconds at scale 1, and some whatever the scale.
auto eyes(double full_ms, double least_ms) {
  return [=](double scale) { return least_ms + full_ms * scale * scale; };
}

TEST(LiveScale, LeavesTheWindowItsPartOfAPeriod) {
  for (const double window_ms : {0.5, 3.0, 4.5})
    for (const double full_ms : {30.0, 300.0, 3000.0}) {
      const LiveScale found = choose_scale(1.0, 90.0, window_ms, eyes(full_ms, 0.2));
      EXPECT_TRUE(found.holds) << window_ms << ' ' << full_ms;
      EXPECT_LE(found.eyes_ms + window_ms, 0.72 * 1e3 / 90.0);
      EXPECT_DOUBLE_EQ(found.eyes_ms, eyes(full_ms, 0.2)(found.scale)) << "of the scale chosen";
      // And not much less than it could have: a step down takes a fifth of the scale at least.
      EXPECT_TRUE(found.scale == 1.0 || found.eyes_ms + window_ms > 0.45 * 1e3 / 90.0 ||
                  eyes(full_ms, 0.2)(found.scale / 0.8) + window_ms > 0.7 * 1e3 / 90.0)
          << found.scale;
    }
}

TEST(LiveScale, NeverExceedsTheSessions) {
  EXPECT_EQ(choose_scale(0.25, 30.0, 1.0, eyes(10.0, 0.1)).scale, 0.25);
  EXPECT_EQ(choose_scale(0.02, 30.0, 1.0, eyes(10.0, 0.1)).scale, 0.02);
  EXPECT_EQ(choose_scale(0.02, 500.0, 5.0, eyes(10.0, 0.1)).scale, 0.02);
}

TEST(LiveScale, SaysWhenTheRateIsOutOfReach) {
  const LiveScale by_window = choose_scale(1.0, 90.0, 12.0, eyes(100.0, 0.1));
  EXPECT_FALSE(by_window.holds);
  EXPECT_DOUBLE_EQ(by_window.scale, 0.03);
  const LiveScale by_eyes = choose_scale(1.0, 90.0, 1.0, eyes(100.0, 20.0));
  EXPECT_FALSE(by_eyes.holds);
}

}  // namespace
}  // namespace brace
