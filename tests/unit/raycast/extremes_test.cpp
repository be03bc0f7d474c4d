// Orders of accuracy on the device, and what a ray caster must survive.
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "runtime/volume/generators.hpp"
#include "tests/unit/raycast/raycast_fixture.hpp"

namespace brace {
namespace {

using Extremes = RaycastTest;
using Order = RaycastTest;
using Counters = RaycastTest;
using Kernel = RaycastTest;

TransferTable constant_table(double kappa, const glm::dvec3& colour) {
  TransferTable table;
  table.range = {0.0, 255.0};
  table.entries.assign(256, {colour.r, colour.g, colour.b, kappa});
  return table;
}

/// A table of 4096 entries from kappa(t) and the colour c(t), t the value.
template <typename Kappa, typename Colour>
TransferTable table_of(double length, const Kappa& kappa, const Colour& colour) {
  TransferTable table;
  table.range = {0.0, length};
  for (int i = 0; i < max_table_entries; ++i) {
    const double t = length * i / (max_table_entries - 1);
    table.entries.push_back({colour(t), 0.0, 0.0, kappa(t)});
  }
  return table;
}

TEST_F(Order, OfTheKernelIsTwo) {
  // Along x the value is the distance t from the ray's entry at the first voxel centre.
  constexpr int length = 16;
  const Volume volume = float_volume({length + 1, 2, 2}, [](int x, int, int) { return x; });
  const VolumeOnDevice on = on_device(volume);
  const double a = 1.3 / 64, pi = std::numbers::pi, size = length;
  struct Problem {
    const char* name;
    TransferTable table;
    double exact;
  };
  const double k0 = 0.5, l = 5.0, k = 0.18;
  const double sigma = 2.5, mu = 6.4, s = std::numbers::sqrt2 * sigma;
  const auto bump = [&](double t) { return 0.4 * std::exp(-(t - mu) * (t - mu) / (s * s)); };
  const auto tau = [&](double t) {
    return 0.4 * sigma * std::sqrt(pi / 2) * (std::erf((t - mu) / s) + std::erf(mu / s));
  };
  const double c5 = 1.0 / tau(size), left = std::exp(-k * size);
  const auto exponential = [&](double t) { return k0 * std::exp(-t / l); };
  const double c3 = exponential(size);  // e = c3 keeps c = e / kappa within 1
  const std::vector<Problem> problems = {
      {"P3b", table_of(size, exponential, [&](double t) { return c3 / exponential(t); }),
       c3 * l * std::exp(-k0 * l) * (std::expint(k0 * l) - std::expint(k0 * l * std::exp(-size / l)))},
      {"P4",
       table_of(
           size, [](double t) { return 1 / (1 + t); }, [&](double t) { return (1 + t) / (1 + size); }),
       std::log(1 + size) / (1 + size)},
      {"P5", table_of(size, bump, [&](double t) { return c5 * tau(t); }),
       c5 * (1 - std::exp(-tau(size)) * (1 + tau(size)))},
      {"P6",
       table_of(
           size, [&](double) { return k; }, [&](double t) { return 0.1 + 0.05 * t; }),
       0.1 * (1 - left) + 0.05 * (1 - left * (1 + k * size)) / k},
  };
  for (const Problem& problem : problems) {
    const auto error = [&](double step) {
      const auto colours = cast_rays(on, problem.table, {{0.5f, 1.0f, 1.0f, float(length)}}, {{1, 0, 0, 0}},
                                     {step, 1.0, false, false});
      return std::abs(static_cast<double>(colours[0].r) - problem.exact);
    };
    EXPECT_NEAR(std::log2(error(2.0) / error(1.0)), 2.0, 0.35) << problem.name;
    EXPECT_LT(error(0.125), 2e-4) << problem.name;
  }
  // kappa = a t, c = 1: exact but for rounding.
  const auto table = table_of(
      size, [&](double t) { return a * t; }, [](double) { return 1.0; });
  const auto colours =
      cast_rays(on, table, {{0.5f, 1.0f, 1.0f, float(length)}}, {{1, 0, 0, 0}}, {1.0, 1.0, false, false});
  EXPECT_NEAR(colours[0].r, -std::expm1(-a * size * size / 2), 2e-6) << "P2a";
}

TEST_F(Extremes, EveryStiffnessStaysBounded) {
  const Volume volume = load("generator:marschner_lobb:12");
  const VolumeOnDevice on = on_device(volume);
  const EyeView eye = look_at_centre({0.3, 0.2, 1.5}, 16, 16);
  for (const double termination : {0.99, 1.0}) {
    for (int exponent = -12; exponent <= 12; exponent += 2) {
      const double kappa = std::pow(10.0, exponent) / 0.5;
      TransferTable table = constant_table(kappa, {1.0, 0.5, 0.0});
      for (std::size_t i = 0; i < 256; i += 2)
        table.entries[i][3] = 0.0;
      const Shot shot = shoot(on, table, eye, {}, {0.5, termination, false, true});
      EXPECT_TRUE(is_bounded(shot.colours)) << kappa;
      const float most = std::max_element(shot.colours.begin(), shot.colours.end(), [](auto& x, auto& y) {
                           return x.a < y.a;
                         })->a;
      if (exponent >= 4) {
        EXPECT_GE(most, termination == 1.0 ? 0.9999f : 0.99f);
      }
    }
  }
}

TEST_F(Extremes, HeadInsideTheVolumeMatchesTheReference) {
  const Volume volume = load("generator:nested_shells:32");
  const TransferTable table = smooth_table(volume, {0.0, 255.0});
  EyeView eye = look_at_centre({0.05, 0.1, 0.2}, 32, 32, 1.9);
  const Shot shot = shoot(volume, table, eye, {});
  EXPECT_LE(difference(shot.colours, reference::render(volume, table, eye, {}, {})).max, 1.0 / 255.0);
  EXPECT_EQ(shot.work.rays, 1024u) << "every ray starts inside";
}

TEST_F(Extremes, AxisParallelRaysMatchTheReference) {
  // An odd image and no tilt: the middle column and row are parallel to two faces, the middle ray to an axis.
  const Volume volume = load("generator:marschner_lobb:20x21x22");
  const TransferTable table = smooth_table(volume, {0.0, 255.0});
  for (const glm::dvec3& offset :
       {glm::dvec3(0.0), glm::dvec3(0.5 * 20 / 22, 0.0, 0.0), glm::dvec3(0.0, 2.0, 0.0)}) {
    EyeView eye = look_at_centre({0, 0, 1.5}, 17, 17);
    eye.world_from_eye.position += offset;  // at the centre, along a face, beside the volume
    const Shot shot = shoot(volume, table, eye, {});
    EXPECT_TRUE(is_bounded(shot.colours));
    const auto expected = reference::render(volume, table, eye, {}, {});
    // Along a face, single precision may see a grazing ray that misses or the other way round.
    if (offset.x == 0.0) {
      EXPECT_LE(difference(shot.colours, expected).max, 1.0 / 255.0);
    }
  }
}

TEST_F(Extremes, OneVoxelIsASlabOfItsValue) {
  for (const char* type : {"uint8", "int16", "uint16", "float32"}) {
    Volume volume = load(std::string("generator:solid_box:1:") + type);
    for (const VolumePath path : {VolumePath::packed, VolumePath::sampler}) {
      const Shot shot =
          shoot(volume, constant_table(0.7, {1, 1, 1}), look_at_centre({0, 0, 2}, 1, 1), {}, {}, path);
      EXPECT_NEAR(shot.colours[0].a, -std::expm1(-0.7), 1e-6) << type;
      EXPECT_NEAR(shot.depths_m[0], 1.5 + 0.25, 1e-6);
    }
  }
}

TEST_F(Extremes, AnEmptyVolumeIsTransparentAndInfinitelyFar) {
  const Volume volume = load("generator:marschner_lobb:16");
  const Shot shot =
      shoot(volume, constant_table(0.0, {1, 1, 1}), look_at_centre({0.3, 0.2, 1.5}, 16, 16), {});
  EXPECT_THAT(shot.colours, testing::Each(glm::vec4(0.0f)));
  EXPECT_THAT(shot.depths_m, testing::Each(INFINITY));
  EXPECT_THAT(shot.image, testing::Each(0u));
}

TEST_F(Extremes, AnOpaqueVolumeShowsItsFirstSample) {
  const Volume volume = load("generator:marschner_lobb:16");
  const double kappa = opaque_optical_depth / 0.25;
  const Shot shot =
      shoot(volume, constant_table(kappa, {0.25, 0.5, 1}), look_at_centre({0, 0, 1}, 1, 1, 0.1), {});
  EXPECT_NEAR(shot.colours[0].r, 0.25, 1e-6);
  EXPECT_NEAR(shot.colours[0].a, 1.0, 1e-6);
  EXPECT_EQ(shot.work.samples, 1u);
}

TEST_F(Extremes, TooManyRaysForTheDeviceAreRefusedWithTheNumberThatFits) {
  const std::uint64_t bytes_max = device().limits().storage_buffer_bytes_max;
  if (bytes_max > std::uint64_t{1} << 30) GTEST_SKIP() << "this device binds more than 1 GiB";
  try {
    RayBuffers(device(), 1 << 14, 1 << 12);
    FAIL() << "64 million rays were accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(std::to_string(bytes_max / 16)));
  }
}

TEST_F(Counters, EqualThoseOfTheReferenceOnTheSameRays) {
  const Volume volume = load("generator:nested_shells:40");
  const TransferTable table = smooth_table(volume, {0.0, 255.0});
  for (const CastSettings& settings :
       {CastSettings{0.5, 1.0, false, true}, CastSettings{0.5, 1.0, true, true}}) {
    const Shot shot = shoot(volume, table, look_at_centre({0.3, 0.4, 1.6}, 48, 48), {}, settings);
    WorkCounts expected;
    for (std::size_t i = 0; i < shot.entries.size(); ++i) {
      const reference::Ray ray{glm::dvec3(shot.entries[i]), glm::dvec3(shot.directions[i]), shot.entries[i].w,
                               0.0};
      const auto result = reference::cast(volume, table, ray, reference_options(settings));
      expected.rays += result.work.rays;
      expected.samples += result.work.samples;
      expected.shading_fetches += result.work.shading_fetches;
    }
    EXPECT_EQ(shot.work.rays, expected.rays);
    EXPECT_EQ(shot.work.samples, expected.samples);
    EXPECT_EQ(shot.work.skip_steps, 0u);
    // A sample at the very edge of visibility may round to either side.
    const auto fetches = static_cast<double>(expected.shading_fetches);
    EXPECT_NEAR(static_cast<double>(shot.work.shading_fetches), fetches, 0.001 * fetches);
    EXPECT_EQ(expected.shading_fetches > 0, settings.phong);
  }
}

TEST_F(Counters, EarlyTerminationSavesSamplesAndOneIsOff) {
  const Volume volume = load("generator:nested_shells:32");
  const TransferTable table = constant_table(1.0, {1, 1, 1});
  const EyeView eye = look_at_centre({0.3, 0.4, 1.6}, 32, 32);
  const auto early = shoot(volume, table, eye, {}, {0.5, 0.99, false, true}).work.samples;
  const auto whole = shoot(volume, table, eye, {}, {0.5, 1.0, false, true}).work.samples;
  EXPECT_LT(early, whole / 2);
}

/// Number of instructions with this opcode.
int count_of(const std::vector<std::uint32_t>& spirv, std::uint32_t opcode) {
  int count = 0;
  for (std::size_t at = 5; at < spirv.size(); at += spirv[at] >> 16)
    count += (spirv[at] & 0xffffu) == opcode;
  return count;
}

/// Whether a function of this name is in the module, called or not.
bool has_function(const std::vector<std::uint32_t>& spirv, const std::string& name) {
  const std::string bytes(reinterpret_cast<const char*>(spirv.data()), spirv.size() * 4);
  return bytes.find(name + "(") != std::string::npos;
}

TEST_F(Kernel, HoldsNothingThatTheSessionDoesNotUse) {
  const VolumeOnDevice on = on_device(load("generator:solid_box:8"), VolumePath::packed);
  constexpr std::uint32_t function_call = 57, atomic_add = 234;
  const auto spirv = [&](bool phong, bool counters) {
    return gpu::compile(compose_cast_kernels(parts({0.5, 0.99, phong, counters}), on).cast, compile_options())
        .spirv;
  };
  const auto plain = spirv(false, false);
  const auto phong = spirv(true, false);
  const auto counting = spirv(false, true);
  EXPECT_TRUE(has_function(plain, "brace_fetch"));
  for (const char* name :
       {"brace_gradient", "brace_shade", "brace_volume", "brace_skip", "brace_count_add"}) {
    EXPECT_FALSE(has_function(plain, name)) << name;
  }
  EXPECT_TRUE(has_function(phong, "brace_gradient"));
  EXPECT_TRUE(has_function(counting, "brace_count_add"));
  EXPECT_LT(count_of(plain, function_call), count_of(phong, function_call));
  EXPECT_LT(count_of(plain, function_call), count_of(counting, function_call));
  EXPECT_EQ(count_of(plain, atomic_add), 0);
  EXPECT_GT(count_of(counting, atomic_add), 0);
}

}  // namespace
}  // namespace brace
