// The exponential midpoint rule against exact solutions (volume rendering integral with known kappa and
// colour).
#include "tests/reference/integrate.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace brace::reference {
namespace {

using Function = std::function<double(double)>;

/// kappa(t) and the emission e(t) = kappa c.
double result_of(const Function& kappa, const Function& emission, double length, double step) {
  const auto medium = [&](double t) {
    const double k = kappa(t);
    return Medium<double>{k, {k > 0.0 ? emission(t) / k : 0.0, 0.0, 0.0}};
  };
  // Colours above 1 are no colours, so the clamp to the opacity is undone by scaling them down.
  const double scale = 1e-3;
  const auto scaled = [&](double t) {
    auto m = medium(t);
    m.colour[0] *= scale;
    return m;
  };
  return integrate(length, step, 1.0, scaled).colour[0] / scale;
}

/// Order between the two finest of the given segment counts.
double observed_order(const Function& kappa, const Function& emission, double length, double exact) {
  const double coarse = std::abs(result_of(kappa, emission, length, length / 64) - exact);
  const double fine = std::abs(result_of(kappa, emission, length, length / 128) - exact);
  return std::log2(coarse / fine);
}

double one(double) {
  return 1.0;
}

TEST(Integrate, IsExactForConstantMedium) {
  const double kappa = 1.7, emission = 0.6, length = 2.3;
  for (const double step : {0.5, 0.07, 1.9, 10.0}) {
    const double found =
        result_of([&](double) { return kappa; }, [&](double) { return emission; }, length, step);
    EXPECT_NEAR(found, emission / kappa * -std::expm1(-kappa * length), 1e-12) << step;
  }
}

TEST(Integrate, IsExactWhereOnlyTheMeanOfKappaMatters) {
  const double a = 1.3, length = 2.0;
  const auto kappa = [&](double t) { return a * t; };
  EXPECT_NEAR(result_of(kappa, kappa, length, length / 16), -std::expm1(-a * length * length / 2), 1e-12);

  // Marschner-Lobb along its axis at radius r over a whole period: kappa = k rho(z), z = t - 1.
  const double alpha = 0.25, k = 0.8, r = 0.4, f = 6.0, pi = std::numbers::pi;
  const double bump = (1 + alpha * (1 + std::cos(2 * pi * f * std::cos(pi * r / 2)))) / (2 * (1 + alpha));
  const auto rho = [&](double t) { return k * (bump - std::sin(pi * (t - 1) / 2) / (2 * (1 + alpha))); };
  EXPECT_NEAR(result_of(rho, rho, 2.0, 2.0 / 32), -std::expm1(-2 * k * bump), 1e-12);
}

TEST(Integrate, ConvergesWithSecondOrder) {
  const double pi = std::numbers::pi;
  {
    const double a = 1.3, length = 2.0;
    const double exact = std::sqrt(pi / (2 * a)) * std::erf(length * std::sqrt(a / 2));
    EXPECT_NEAR(observed_order([&](double t) { return a * t; }, one, length, exact), 2.0, 0.1) << "P2b";
  }
  {
    const double k0 = 2.0, l = 0.7, length = 2.0;
    const double exact =
        l * std::exp(-k0 * l) * (std::expint(k0 * l) - std::expint(k0 * l * std::exp(-length / l)));
    EXPECT_NEAR(observed_order([&](double t) { return k0 * std::exp(-t / l); }, one, length, exact), 2.0, 0.1)
        << "P3b";
  }
  EXPECT_NEAR(observed_order([](double t) { return 1 / (1 + t); }, one, 3.0, std::log(4.0)), 2.0, 0.1)
      << "P4";
  {
    const double k0 = 3.0, sigma = 0.3, mu = 0.8, length = 2.0;
    const auto kappa = [&](double t) { return k0 * std::exp(-(t - mu) * (t - mu) / (2 * sigma * sigma)); };
    const auto tau = [&](double t) {
      const double s = std::numbers::sqrt2 * sigma;
      return k0 * sigma * std::sqrt(pi / 2) * (std::erf((t - mu) / s) + std::erf(mu / s));
    };
    const double exact = 1 - std::exp(-tau(length)) * (1 + tau(length));
    EXPECT_NEAR(observed_order(
                    kappa, [&](double t) { return kappa(t) * tau(t); }, length, exact),
                2.0, 0.1)
        << "P5";
  }
  {
    const double k = 1.4, c0 = 0.2, c1 = 0.3, length = 2.0;
    const double left = std::exp(-k * length);
    const double exact = c0 * (1 - left) + c1 * (1 - left * (1 + k * length)) / k;
    EXPECT_NEAR(
        observed_order([&](double) { return k; }, [&](double t) { return k * (c0 + c1 * t); }, length, exact),
        2.0, 0.1)
        << "P6";
  }
}

TEST(Integrate, MissesAStepInTheMediumByNoMoreThanItsOpticalDepth) {
  const double big = 5.0, length = 1.0;
  for (const double edge : {0.31, 0.5, 0.777}) {
    for (const double step : {0.1, 0.013}) {
      const auto kappa = [&](double t) { return t > edge ? big : 0.0; };
      const double found = result_of(kappa, kappa, length, step);
      EXPECT_LE(std::abs(found + std::expm1(-big * (length - edge))), big * step) << edge << " " << step;
    }
  }
}

TEST(Integrate, StaysBoundedInSinglePrecisionForEveryStiffness) {
  for (double exponent = -12.0; exponent <= 12.0; exponent += 0.5) {
    const auto kappa = static_cast<float>(std::pow(10.0, exponent));
    const auto medium = [&](float t) { return Medium<float>{kappa * t, {1.0f, 0.5f * t / 40.0f, 0.0f}}; };
    const auto found = integrate(40.3f, 1.0f, 1.0f, medium);
    EXPECT_GE(found.opacity, 0.0f);
    EXPECT_LE(found.opacity, 1.0f);
    for (const float c : found.colour)
      EXPECT_TRUE(c >= 0.0f && c <= found.opacity) << exponent;
  }
}

TEST(Integrate, DoesNotStallInSinglePrecision) {
  // 4096 steps, optical depth 14: summing opacities instead loses 1 - A altogether.
  const auto thin = [](float) { return Medium<float>{14.0f / 4096.0f, {1.0f, 1.0f, 1.0f}}; };
  const auto found = integrate(4096.0f, 1.0f, 1.0f, thin);
  EXPECT_NEAR(found.opacity, -std::expm1(-14.0), 1e-6);
  EXPECT_NEAR(found.colour[0], -std::expm1(-14.0), 1e-4);
}

TEST(Integrate, EndsEarlyOnceOpaqueEnough) {
  const auto medium = [](double) { return Medium<double>{1.0, {1.0, 1.0, 1.0}}; };
  EXPECT_EQ(integrate(100.0, 1.0, 0.99, medium).samples, 5);  // exp(-5) < 0.01 < exp(-4)
  EXPECT_EQ(integrate(100.0, 1.0, 1.0, medium).samples, 100);
}

}  // namespace
}  // namespace brace::reference
