#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/timeline/cost_model.hpp"

namespace brace {
namespace {

CostModel truth() {
  return {
      .name = "truth",
      .summary = "",
      .base_ns = {.cast = 120'000, .warp = 40'000, .update = 0},
      .item_ns = {
          .ray = 3.5, .sample = 0.31, .skip_step = 0.15, .shading_fetch = 0.027, .texel = 0.09, .byte = 0}};
}

std::vector<CostSample> samples_of(const CostModel& model, double noise) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0.0, noise);
  const auto upto = [&](std::uint64_t most) { return random() % most; };
  std::vector<CostSample> samples;
  for (int i = 0; i < 400; ++i) {
    CostSample sample;
    if (i % 2 == 0) {
      sample.kind = JobKind::cast;
      sample.work = {.rays = upto(500'000),
                     .samples = upto(90'000'000),
                     .skip_steps = upto(30'000'000),
                     .shading_fetches = upto(200'000'000)};
    } else {
      sample.kind = JobKind::warp;
      sample.work = {.texels = upto(5'000'000)};
    }
    const double ns =
        static_cast<double>(evaluate(model, sample.kind, sample.work).count()) * (1 + normal(random));
    sample.time = SimDuration(std::llround(ns));
    samples.push_back(sample);
  }
  return samples;
}

void expect_near_relative(double value, double expected, double tolerance) {
  EXPECT_NEAR(value, expected, tolerance * expected);
}

TEST(CostFit, RecoversAModelFromItsOwnTimes) {
  const CostModel model = truth();
  const CostFit fit = fit_cost_model(samples_of(model, 0.0), "fitted");
  EXPECT_EQ(fit.model.name, "fitted");
  expect_near_relative(fit.model.base_ns.cast, model.base_ns.cast, 1e-4);
  expect_near_relative(fit.model.base_ns.warp, model.base_ns.warp, 1e-4);
  expect_near_relative(fit.model.item_ns.ray, model.item_ns.ray, 1e-4);
  expect_near_relative(fit.model.item_ns.sample, model.item_ns.sample, 1e-6);
  expect_near_relative(fit.model.item_ns.skip_step, model.item_ns.skip_step, 1e-6);
  expect_near_relative(fit.model.item_ns.shading_fetch, model.item_ns.shading_fetch, 1e-6);
  expect_near_relative(fit.model.item_ns.texel, model.item_ns.texel, 1e-6);
  EXPECT_LT(fit.max_relative_error, 1e-5);  // times are whole nanoseconds
  EXPECT_EQ(fit.unobserved, (std::vector<std::string>{"base_ns.update", "item_ns.byte"}));
}

TEST(CostFit, FivePercentNoiseMovesTheMainPricesByLessThanFivePercent) {
  const CostModel model = truth();
  const CostFit fit = fit_cost_model(samples_of(model, 0.05), "noisy");
  expect_near_relative(fit.model.item_ns.sample, model.item_ns.sample, 0.05);
  expect_near_relative(fit.model.item_ns.shading_fetch, model.item_ns.shading_fetch, 0.05);
  expect_near_relative(fit.model.item_ns.texel, model.item_ns.texel, 0.05);
  EXPECT_NEAR(fit.rms_relative_error, 0.05, 0.01);
}

TEST(CostFit, PricesAreNeverNegative) {
  // More rays go with less time: an unconstrained fit would price rays below zero.
  std::vector<CostSample> samples;
  for (std::uint64_t i = 1; i <= 20; ++i) {
    samples.push_back({.kind = JobKind::cast,
                       .work = {.rays = 1000 * (21 - i), .samples = 1'000'000 * i},
                       .time = SimDuration(static_cast<std::int64_t>(500'000 * i) - 200'000)});
  }
  const CostModel model = fit_cost_model(samples, "signed").model;
  EXPECT_GE(model.item_ns.ray, 0);
  EXPECT_GE(model.base_ns.cast, 0);
  EXPECT_GT(model.item_ns.sample, 0.3);
}

TEST(CostFit, OptimalityConditionsOfNonNegativeLeastSquaresHold) {
  // Karush-Kuhn-Tucker: with weights 1/t, the gradient of the error is 0 for positive prices and >= 0 for
  // prices at 0. An independent check of the solver.
  std::mt19937_64 random(9);
  for (int round = 0; round < 50; ++round) {
    std::vector<CostSample> samples;
    for (int i = 0; i < 12; ++i) {
      samples.push_back({.kind = JobKind::cast,
                         .work = {.rays = random() % 100,
                                  .samples = random() % 100,
                                  .skip_steps = random() % 100,
                                  .texels = random() % 100},
                         .time = SimDuration(1 + static_cast<std::int64_t>(random() % 1000))});
    }
    const CostModel m = fit_cost_model(samples, "kkt").model;
    const double prices[] = {m.base_ns.cast, m.item_ns.ray, m.item_ns.sample, m.item_ns.skip_step,
                             m.item_ns.texel};
    double gradient[5] = {}, size[5] = {};
    for (const CostSample& s : samples) {
      const double t = static_cast<double>(s.time.count());
      const double counts[] = {1, static_cast<double>(s.work.rays), static_cast<double>(s.work.samples),
                               static_cast<double>(s.work.skip_steps), static_cast<double>(s.work.texels)};
      double predicted = 0;
      for (int k = 0; k < 5; ++k)
        predicted += prices[k] * counts[k];
      for (int k = 0; k < 5; ++k) {
        gradient[k] += (predicted - t) / t * counts[k] / t;
        size[k] += counts[k] / t;
      }
    }
    for (int k = 0; k < 5; ++k) {
      EXPECT_GE(prices[k], 0);
      EXPECT_GE(gradient[k], -1e-9 * size[k]) << "price " << k << " should have been raised";
      if (prices[k] > 0) {
        EXPECT_LE(gradient[k], 1e-9 * size[k]) << "price " << k << " should have been lowered";
      }
    }
  }
}

TEST(CostFit, WithoutAMeasuredJobThereIsNothingToFit) {
  EXPECT_THROW(fit_cost_model({}, "none"), Error);
  EXPECT_THROW(fit_cost_model(std::vector<CostSample>(3), "zero times"), Error);
}

}  // namespace
}  // namespace brace
