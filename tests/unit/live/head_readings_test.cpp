#include "tools/live/head_readings.hpp"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "hmd_sim/predictors.hpp"
#include "hmd_sim/tracker.hpp"

namespace brace {
namespace {

/// Turns about a tilted axis and moves, both evenly.
Pose pose_at(SimTime time) {
  const double t = to_s(time);
  return {quat_exp(glm::dvec3(0.3, 0.8, -0.1) * t) * quat_exp({0.2, 0.1, 0.0}),
          {0.1 + 0.5 * t, 1.6, -0.3 * t}};
}

TEST(HeadReadings, LetAPredictorGoOnAnEvenMotion) {
  HeadReadings readings;
  for (const int ms : {0, 11, 22, 40, 51})
    readings.add(sim_time(ms * 1'000'000LL), pose_at(sim_time(ms * 1'000'000LL)));
  EXPECT_EQ(readings.all().size(), HeadReadings::kept);
  const SimTime target = sim_time(80'000'000);
  const Pose expected = pose_at(target), found = sim::predict_constant_rate(readings.all(), target);
  EXPECT_LT(glm::length(quat_log(glm::conjugate(expected.orientation) * found.orientation)), 1e-9);
  EXPECT_LT(glm::distance(expected.position, found.position), 1e-9);
}

TEST(HeadReadings, KeepTheirDistance) {
  HeadReadings readings;
  for (int us = 0; us <= 60'000; us += 700)
    readings.add(sim_time(us * 1000LL), pose_at(sim_time(us * 1000LL)));
  ASSERT_EQ(readings.all().size(), HeadReadings::kept);
  EXPECT_EQ(readings.all().back().time_ns, 59'500'000) << "the newest is there";
  for (std::size_t i = 1; i + 1 < readings.all().size(); ++i)
    EXPECT_GE(readings.all()[i].time_ns - readings.all()[i - 1].time_ns, to_ns(HeadReadings::spacing_min));
  readings.forget();
  readings.add(sim_time(70'000'000), pose_at(sim_time(0)));
  readings.add(sim_time(70'000'000), pose_at(sim_time(0)));  // the same time again
  ASSERT_EQ(readings.all().size(), 1U);
  EXPECT_EQ(readings.all()[0].linear_velocity_m_s[0], 0.0) << "the first knows no velocity";
}

}  // namespace
}  // namespace brace
