#include <cmath>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "hmd_sim/predictors.hpp"
#include "stages/control/control.hpp"
#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

const brace_stage_descriptor* const built_in[] = {
    &stages::predict_none,    &stages::predict_constant_rate, &stages::predict_constant_acceleration,
    &stages::predict_kalman,  &stages::control_fixed,         &stages::control_pi,
    &stages::control_quantile};

std::vector<brace_tracker_sample> turning_history() {
  const sim::PoseTrace trace = sim::generate_trace({.motion = sim::Motion::natural, .seconds = 1});
  sim::Tracker tracker(trace, {.rate = {1000, 1}}, 1);
  const auto history = tracker.history(sim_time(500'000'000));
  return {history.begin(), history.end()};
}

Pose predict_by(const brace_stage_descriptor& descriptor, const std::vector<double>& values,
                const std::vector<brace_tracker_sample>& history, std::int64_t target_ns) {
  void* self = descriptor.create(values.data(), descriptor.param_count);
  brace_pose pose{};
  const auto* functions = static_cast<const brace_predict_functions*>(descriptor.functions);
  EXPECT_EQ(
      functions->predict(self, history.data(), static_cast<std::uint32_t>(history.size()), target_ns, &pose),
      BRACE_OK);
  descriptor.destroy(self);
  return sim::from_abi(pose);
}

void expect_same(const Pose& a, const Pose& b) {
  EXPECT_EQ(a.orientation, b.orientation);
  EXPECT_EQ(a.position, b.position);
}

TEST(BuiltInStages, DescriptorsAreCompleteAndTheirDefaultsInRange) {
  for (const brace_stage_descriptor* d : built_in) {
    EXPECT_EQ(d->struct_size, sizeof(brace_stage_descriptor));
    EXPECT_GT(std::strlen(d->name), 0U);
    EXPECT_GT(std::strlen(d->help), 0U);
    ASSERT_NE(d->functions, nullptr);
    EXPECT_GT(*static_cast<const std::uint32_t*>(d->functions), 0U) << "struct_size of the table";
    for (std::uint32_t i = 0; i < d->param_count; ++i) {
      const brace_param& p = d->params[i];
      EXPECT_EQ(p.struct_size, sizeof(brace_param));
      EXPECT_LE(p.minimum, p.default_value);
      EXPECT_LE(p.default_value, p.maximum);
    }
    const Stage made(*d);
  }
}

TEST(BuiltInStages, PredictorsAreThePureFunctions) {
  const std::vector<brace_tracker_sample> history = turning_history();
  for (const std::int64_t ahead_ns : {-3'000'000LL, 0LL, 20'000'000LL}) {
    const std::int64_t target_ns = history.back().time_ns + ahead_ns;
    const SimTime target = sim_time(target_ns);
    expect_same(predict_by(stages::predict_none, {}, history, target_ns), sim::predict_none(history, target));
    expect_same(predict_by(stages::predict_constant_rate, {100}, history, target_ns),
                sim::predict_constant_rate(history, target));
    expect_same(predict_by(stages::predict_constant_acceleration, {120, 60, 60}, history, target_ns),
                sim::predict_constant_acceleration(history, target));
  }
}

TEST(BuiltInStages, ConstantRateStopsAtItsHorizon) {
  const std::vector<brace_tracker_sample> history = turning_history();
  const std::int64_t newest_ns = history.back().time_ns;
  expect_same(predict_by(stages::predict_constant_rate, {10}, history, newest_ns + 5'000'000'000),
              sim::predict_constant_rate(history, sim_time(newest_ns + 10'000'000)));
}

TEST(BuiltInStages, ConstantAccelerationTakesItsLimitsFromItsParameters) {
  const std::vector<brace_tracker_sample> history = turning_history();
  const std::int64_t target_ns = history.back().time_ns + 20'000'000;
  // A limit of 0 takes every acceleration for noise: constant rate.
  expect_same(predict_by(stages::predict_constant_acceleration, {0, 0, 60}, history, target_ns),
              sim::predict_constant_acceleration(history, sim_time(target_ns),
                                                 {.angular_rad_s2 = 0, .linear_m_s2 = 0, .horizon = ms(60)}));
}

TEST(BuiltInStages, FixedControlAsksForEverything) {
  const Stage fixed(stages::control_fixed);
  double quality = 0;
  brace_control_input input{};
  input.struct_size = sizeof(input);
  input.frame_cost_ns = 1'000'000'000;
  input.missed = 90;
  EXPECT_EQ(fixed.control().functions->update(fixed.control().self, &input, &quality), BRACE_OK);
  EXPECT_EQ(quality, 1.0);
}

TEST(BuiltInStages, PiRefusesGainsThatDoNotSettleAtTheDelay) {
  // target, gain_p, gain_i, cost_exponent, quality_min
  const double values[] = {0.85, 0.0, 0.8, 1.0, 0.05};
  void* self = stages::control_pi.create(values, 5);
  const auto* functions = static_cast<const brace_control_functions*>(stages::control_pi.functions);
  brace_control_input input{};
  input.struct_size = sizeof(input);
  input.frame_cost_ns = 5'000'000;
  input.budget_ns = 10'000'000;
  double quality = 0;
  input.delay_frames = 1;  // bound 1
  EXPECT_EQ(functions->update(self, &input, &quality), BRACE_OK);
  EXPECT_EQ(quality, 1.0);
  input.delay_frames = 2;  // bound 0.618
  EXPECT_EQ(functions->update(self, &input, &quality), BRACE_UNSUPPORTED);
  EXPECT_NE(std::string(stages::control_pi.last_error(self)).find("gain_i = 0.8"), std::string::npos);
  stages::control_pi.destroy(self);
}

}  // namespace
}  // namespace brace
