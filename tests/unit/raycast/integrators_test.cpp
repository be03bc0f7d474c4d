// The integrators of cast/dvr: exact solutions, the double-precision reference, stiffness, adaptive steps.
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "runtime/volume/preintegration.hpp"
#include "tests/unit/raycast/raycast_fixture.hpp"

namespace brace {
namespace {

using Integrators = RaycastTest;
using Adaptive = RaycastTest;

CastSettings with(const std::string& integrator, double step = 0.5, double termination = 1.0) {
  CastSettings settings;
  settings.step_voxels = step;
  settings.termination = termination;
  settings.integrator = integrator;
  return settings;
}

CastSettings with_tolerance(double tolerance, const std::string& integrator = "linear-source") {
  CastSettings settings = with(integrator);
  settings.tolerance = tolerance;
  return settings;
}

std::vector<CastSettings> all_rules(double step = 0.5) {
  std::vector<CastSettings> rules;
  for (const char* name : {"midpoint-exponential", "left", "linear-source", "pre-integrated"})
    rules.push_back(with(name, step));
  rules.push_back(with("pre-integrated", step));
  rules.back().preintegration = "integral";
  return rules;
}

template <typename Kappa, typename Colour>
TransferTable table_of(double length, int entries, const Kappa& kappa, const Colour& colour) {
  TransferTable table;
  table.range = {0.0, length};
  for (int i = 0; i < entries; ++i) {
    const double t = length * i / (entries - 1);
    table.entries.push_back({colour(t), 0.0, 0.0, kappa(t)});
  }
  return table;
}

TEST_F(Integrators, HaveTheirOrderOnExactSolutions) {
  // Along x the value is the distance t. P4: kappa = 1 / (1 + t), e = 1 / (1 + L); P6: constant kappa, linear
  // c.
  constexpr int length = 16;
  const VolumeOnDevice on = on_device(float_volume({length + 1, 2, 2}, [](int x, int, int) { return x; }));
  const double size = length, k = 0.18, left = std::exp(-k * size);
  struct Problem {
    const char* name;
    TransferTable table;
    double exact;
  };
  const std::vector<Problem> problems = {
      {"P4",
       table_of(
           size, max_table_entries, [](double t) { return 1 / (1 + t); },
           [&](double t) { return (1 + t) / (1 + size); }),
       std::log(1 + size) / (1 + size)},
      {"P6",
       table_of(
           size, max_table_entries, [&](double) { return k; }, [&](double t) { return 0.1 + 0.05 * t; }),
       0.1 * (1 - left) + 0.05 * (1 - left * (1 + k * size)) / k},
  };
  for (const Problem& problem : problems) {
    const bool linear = std::string(problem.name) == "P6";
    for (const CastSettings& rule : all_rules()) {
      const auto error = [&](double step) {
        CastSettings settings = rule;
        settings.step_voxels = step;
        const auto colours =
            cast_rays(on, problem.table, {{0.5f, 1.0f, 1.0f, float(length)}}, {{1, 0, 0, 0}}, settings);
        return std::abs(static_cast<double>(colours[0].r) - problem.exact);
      };
      const std::string name = std::string(problem.name) + " " + rule.integrator + " " + rule.preintegration;
      if (rule.integrator == "linear-source" && linear) {
        EXPECT_LT(error(4.0), 2e-6) << name << ": exact";
        continue;
      }
      // The value is linear here and the order within a step is kept: the 2D table is exact but for its grid.
      if (rule.integrator == "pre-integrated" && rule.preintegration == "table") {
        EXPECT_LT(error(2.0), 1e-3) << name;
        continue;
      }
      const double order = rule.integrator == "left" ? 1.0 : 2.0;
      const double step = linear ? 2.0 : 1.0;
      EXPECT_NEAR(std::log2(error(step) / error(step / 2)), order, 0.35) << name;
    }
  }
}

TEST_F(Integrators, MatchTheReferencePicture) {
  const Volume volume = load("generator:nested_shells:24");
  const TransferTable table = smooth_table(volume, {0.0, 255.0});
  const EyeView eye = look_at_centre({0.3, 0.4, 1.6}, 20, 20);
  for (const bool phong : {false, true}) {
    for (CastSettings rule : all_rules()) {
      rule.phong = phong;
      const bool ordered = rule.integrator != "pre-integrated" || rule.preintegration == "table";
      const Shot shot = shoot(volume, table, eye, {}, rule);
      const auto expected = reference::render(volume, table, eye, {}, reference_options(rule));
      EXPECT_LE(difference(shot.colours, expected).max, ordered ? 2e-3 : 1e-2)
          << rule.integrator << " " << rule.preintegration << phong;
      EXPECT_LE(difference(shot.colours, expected).rms, ordered ? 2e-4 : 1e-3)
          << rule.integrator << " " << rule.preintegration << phong;
      EXPECT_NEAR(static_cast<double>(shot.work.samples), static_cast<double>(expected.work.samples),
                  0.01 * static_cast<double>(expected.work.samples));
    }
  }
}

TEST_F(Integrators, OnlyPreIntegrationSeesAThinBand) {
  // From 40 to 200 within a voxel; visible on 100 … 130 only, opaque there.
  const VolumeOnDevice on =
      on_device(float_volume({8, 2, 2}, [](int x, int, int) { return x < 4 ? 40 : 200; }));
  TransferTable table = table_of(
      255.0, 256, [](double v) { return v > 100 && v < 130 ? 200.0 : 0.0; }, [](double) { return 0.5; });
  const auto opacity = [&](const CastSettings& settings) {
    return cast_rays(on, table, {{0.5f, 1.0f, 1.0f, 7.0f}}, {{1, 0, 0, 0}}, settings)[0].a;
  };
  for (const CastSettings& rule : all_rules(1.0)) {
    if (rule.integrator == "midpoint-exponential") continue;  // a sample lies in the band by chance
    const double exact = 1 - std::exp(-200.0 * 29.0 / 160.0);
    if (rule.integrator == "pre-integrated") {
      EXPECT_NEAR(opacity(rule), exact, 1e-4);
    } else {
      EXPECT_EQ(opacity(rule), 0.0f) << rule.integrator;
    }
  }
  EXPECT_NEAR(opacity(with_tolerance(1e-3, "pre-integrated")), 1.0, 1e-3);
}

TEST_F(Integrators, StayBoundedAtEveryStiffness) {
  const VolumeOnDevice on = on_device(load("generator:marschner_lobb:12"));
  const EyeView eye = look_at_centre({0.3, 0.2, 1.5}, 12, 12);
  std::vector<CastSettings> rules = all_rules();
  rules.push_back(with_tolerance(1e-3));
  rules.push_back(with_tolerance(1e-3, "pre-integrated"));
  for (const CastSettings& rule : rules) {
    for (int exponent = -12; exponent <= 12; exponent += 8) {
      TransferTable table = table_of(
          255.0, 256, [&](double) { return 2 * std::pow(10.0, exponent); }, [](double v) { return v / 255; });
      for (std::size_t i = 0; i < 256; i += 2)
        table.entries[i][3] = 0.0;
      const Shot shot = shoot(on, table, eye, {}, rule);
      EXPECT_TRUE(is_bounded(shot.colours)) << rule.integrator << rule.tolerance << " " << exponent;
      const float most = std::max_element(shot.colours.begin(), shot.colours.end(), [](auto& x, auto& y) {
                           return x.a < y.a;
                         })->a;
      EXPECT_GT(most, 0.0f) << rule.integrator << " " << exponent;
      if (exponent > 4) {
        EXPECT_GE(most, 0.9999f) << rule.integrator << " " << exponent;
      }
    }
  }
}

TEST_F(Adaptive, FollowsTheToleranceWithFewerSamples) {
  const Volume volume = load("generator:marschner_lobb:24");
  const TransferTable table = smooth_table(volume, {0.0, 255.0});
  const EyeView eye = look_at_centre({0.3, 0.4, 1.6}, 24, 24);
  const VolumeOnDevice on = on_device(volume);
  const Shot exact = shoot(on, table, eye, {}, with("linear-source", 1.0 / 64));
  std::uint64_t samples = ~std::uint64_t{0};
  double rms = 0.0;
  for (const double tolerance : {1e-4, 1e-3, 1e-2}) {
    const Shot shot = shoot(on, table, eye, {}, with_tolerance(tolerance));
    const Difference error = difference(shot.colours, exact.colours);
    EXPECT_LE(error.rms, std::max(tolerance, 3e-4)) << "3e-4: what lies between samples a voxel apart";
    EXPECT_LT(shot.work.samples, samples) << "a looser tolerance takes fewer samples";
    EXPECT_GE(error.rms, rms) << "and gives no smaller error";
    samples = shot.work.samples;
    rms = error.rms;
  }
}

TEST(Preintegration, IntegralsAreExactAndFlatWhereNothingIsVisible) {
  TransferTable table = table_of(
      255.0, 256, [](double v) { return v > 100 && v < 130 ? v / 100 : 0.0; },
      [](double v) { return v / 255; });
  const TransferIntegrals integrals = integrate(table, 0.5);
  EXPECT_EQ(integrals[20], integrals[99]);
  EXPECT_EQ(integrals[140], integrals[255]);
  // By very many midpoints.
  const double from = 97.3, to = 118.9;
  double depth = 0.0, colour = 0.0;
  constexpr int pieces = 200'000;
  for (int i = 0; i < pieces; ++i) {
    const TransferSample here = lookup(table, from + (to - from) * (i + 0.5) / pieces);
    const double w = here.kappa * 0.5 * std::numbers::log2e * (to - from) / pieces;
    depth += w;
    colour += w * here.r;
  }
  const auto low = integral_up_to(integrals, table, 0.5, from),
             high = integral_up_to(integrals, table, 0.5, to);
  EXPECT_NEAR(high[3] - low[3], depth, 1e-8);
  EXPECT_NEAR(high[0] - low[0], colour, 1e-8);
}

TEST(Preintegration, SegmentsKeepTheOrderOfFrontAndBack) {
  // Red before blue, both opaque: who is in front is seen.
  TransferTable table;
  table.range = {0.0, 255.0};
  for (int i = 0; i < 256; ++i)
    table.entries.push_back({i < 128 ? 1.0 : 0.0, 0.0, i < 128 ? 0.0 : 1.0, 40.0});
  const TransferIntegrals integrals = integrate(table, 0.5);
  const int size = segment_table_size(table);
  const auto segments = preintegrated_segments(table, integrals, 0.5, size);
  const auto at = [&](int front, int back) {
    return segments[static_cast<std::size_t>(back * size + front)];
  };
  EXPECT_GT(at(10, 240)[0], 0.99f);
  EXPECT_LT(at(10, 240)[2], 0.01f);
  EXPECT_GT(at(240, 10)[2], 0.99f);
  EXPECT_NEAR(at(10, 10)[3], -std::expm1(-20.0), 1e-6);
}

}  // namespace
}  // namespace brace
