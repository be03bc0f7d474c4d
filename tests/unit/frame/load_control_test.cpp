#include "stages/control/load_control.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "hmd_sim/random.hpp"
#include "runtime/verify/load_loop.hpp"

namespace brace::stages {
namespace {

double bound_of(std::uint32_t delay) {
  return 2.0 * std::sin(std::numbers::pi / (2.0 * (2.0 * delay + 1.0)));
}

TEST(LoadControl, PureIntegralGainsHaveTheBoundOfTheFormula) {
  EXPECT_NEAR(bound_of(1), 1.0, 1e-12);
  EXPECT_NEAR(bound_of(2), 0.618, 1e-3);
  for (std::uint32_t delay = 0; delay <= 40; ++delay) {
    EXPECT_TRUE(pi_control_is_stable(0.0, 0.999 * bound_of(delay), delay)) << delay;
    EXPECT_FALSE(pi_control_is_stable(0.0, 1.001 * bound_of(delay), delay)) << delay;
  }
  EXPECT_FALSE(pi_control_is_stable(0.0, 0.0, 0));
  EXPECT_FALSE(pi_control_is_stable(0.0, std::nan(""), 0));
  EXPECT_FALSE(pi_control_is_stable(0.1, 0.1, 1'000'000));
}

/// What is left of a small disturbance after many frames of the linear loop.
double left_over(double p, double i, std::uint32_t delay) {
  std::deque<double> u(delay + 2, 0.0);  // newest first
  u[0] = 1e-3;
  double before = 0.0;
  for (int k = 0; k < 20'000; ++k) {
    const double error = u[delay];
    u.push_front(u[0] - p * (error - before) - i * error);
    before = error;
    u.pop_back();
    if (std::abs(u[0]) > 1e3) return u[0];
  }
  return *std::max_element(u.begin(), u.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
}

TEST(LoadControl, TheCheckAgreesWithTheLoopItself) {
  int settled = 0, grown = 0;
  for (std::uint32_t delay = 0; delay <= 4; ++delay) {
    for (double p = 0.0; p < 1.2; p += 0.17) {
      for (double i = 0.03; i < 2.2; i += 0.19) {
        const double left = std::abs(left_over(p, i, delay));
        if (left > 1e-6 && left < 1.0) continue;  // next to the border
        EXPECT_EQ(pi_control_is_stable(p, i, delay), left <= 1e-6) << p << " " << i << " " << delay;
        ++(left <= 1e-6 ? settled : grown);
      }
    }
  }
  EXPECT_GT(settled, 30);
  EXPECT_GT(grown, 30);
}

/// The loop of the load given, with 5 % of noise.
LoadLoop drive(const std::function<double(const FrameLoad&)>& update, const std::function<double(int)>& load,
               int frames, std::size_t delay) {
  const auto noisy = [&](int k) {
    const double noise =
        sim::near_normal(sim::random_bits(sim::stream_of(7, 0), static_cast<std::uint64_t>(k)));
    return load(k) * std::exp(0.05 * noise);
  };
  return drive_load(update, noisy, frames, delay);
}

TEST(LoadControl, PiFindsTheTargetAfterALoadStepAndDoesNotWindUp) {
  PiControl control({.target = 0.85, .p = 0.1, .i = 0.3, .quality_min = 0.05});
  const auto update = [&](const FrameLoad& load) { return control.update(load); };
  const LoadLoop high = drive(
      update, [](int) { return 5.0; }, 500, 1);
  EXPECT_NEAR(high.quality * 5.0, 0.85, 0.1);
  // A load that no quality bears, for long; then back: nothing has piled up.
  (void)drive(
      update, [](int) { return 1e6; }, 5000, 1);
  const LoadLoop back = drive(
      update, [](int) { return 0.5; }, 20, 1);
  EXPECT_EQ(back.quality, 1.0);
}

TEST(LoadControl, QuantileHoldsItsShareAndItsGuarantee) {
  for (const bool proportional : {false, true}) {
    QuantileControl control(
        {.missed_share = 0.01, .step = 0.1, .quality_min = 0.05, .proportional_cut = proportional});
    const auto update = [&](const FrameLoad& load) { return control.update(load); };
    const LoadLoop steps = drive(update, tenfold_load_step, 3000, 1);
    const double range = -std::log(0.05);
    EXPECT_LE(steps.missed_share, 0.01 + 0.99 * (range + 0.1) / (0.1 * 3000)) << proportional;
    if (proportional) {
      EXPECT_LE(steps.longest_run, 4);
    }
    const LoadLoop steady = drive(
        update, [](int) { return 2.0; }, 20'000, 1);
    EXPECT_LT(steady.missed_share, 0.015) << proportional;
    EXPECT_GT(steady.missed_share, 0.004) << "neither is quality given away";
  }
}

TEST(LoadControl, PiMissesMoreThanQuantileOnAStep) {
  PiControl pi({.target = 1.0, .p = 0.0, .i = 0.3, .quality_min = 0.05});
  QuantileControl quantile({});
  const LoadLoop a =
      drive([&](const FrameLoad& load) { return pi.update(load); }, tenfold_load_step, 3000, 1);
  const LoadLoop b =
      drive([&](const FrameLoad& load) { return quantile.update(load); }, tenfold_load_step, 3000, 1);
  EXPECT_GT(a.missed_share, b.missed_share);
}

TEST(LoadControl, WindowFollowsChangesOfTheLoadAndRestsBetweenItsThresholds) {
  WindowControl control({});
  const auto update = [&](const FrameLoad& load) { return control.update(load); };
  EXPECT_EQ(drive(
                update, [](int) { return 0.5; }, 200, 1)
                .quality,
            1.0);
  // Once the load has grown tenfold, it is soon within the budget, and then finds the thresholds.
  const LoadLoop grown = drive(
      update, [](int frame) { return frame < 100 ? 0.5 : 5.0; }, 120, 1);
  EXPECT_LT(grown.quality * 5.0, 1.0);
  EXPECT_LT(grown.longest_run, 10);
  const LoadLoop rested = drive(
      update, [](int) { return 5.0; }, 600, 1);
  EXPECT_NEAR(rested.quality * 5.0, 0.82, 0.15);
  // A start under overload is a change as well.
  WindowControl fresh({});
  EXPECT_LT(drive([&](const FrameLoad& load) { return fresh.update(load); }, [](int) { return 5.0; }, 20, 1)
                .quality,
            0.22);
}

TEST(LoadControl, ExtremeCostsStayNumbers) {
  PiControl pi({});
  QuantileControl quantile({});
  WindowControl window({});
  for (const double cost : {0.0, 1e-300, 1e-12, 1.0, 1e12, 1e300, std::numeric_limits<double>::infinity()}) {
    for (int k = 0; k < 5; ++k) {
      const FrameLoad load{cost, cost > 1.0};
      for (const double quality : {pi.update(load), quantile.update(load), window.update(load)}) {
        EXPECT_GE(quality, 0.05 * (1 - 1e-12)) << cost;
        EXPECT_LE(quality, 1.0) << cost;
      }
    }
  }
}

}  // namespace
}  // namespace brace::stages
