// cast/native through its C interface, without a device: against the double-precision cast/reference, and
// with skip maps against itself, on every instruction set that this processor has.
#include <array>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/unit/native_cast/native_cast_rig.hpp"

namespace brace {
namespace {

struct Case {
  std::array<std::uint32_t, 3> dims;
  std::uint32_t across, down;
};
constexpr std::array<Case, 5> cases = {
    {{{1, 1, 1}, 1, 1}, {{9, 5, 3}, 7, 5}, {{17, 16, 21}, 33, 18}, {{1, 30, 2}, 4, 4}, {{33, 1, 1}, 2, 9}}};

TEST(NativeCast, AgreesWithTheReferenceOnEveryInstructionSet) {
  Random random(7);
  for (const brace_voxel_type type :
       {BRACE_VOXEL_UINT8, BRACE_VOXEL_INT16, BRACE_VOXEL_UINT16, BRACE_VOXEL_FLOAT32}) {
    const TestTransfer transfer(range_of(type));
    for (const Case& one : cases) {
      const TestVolume volume = random_volume(one.dims, type, random);
      const TestRays rays = random_rays(one.across, one.down, volume, random);
      Caster reference(REFERENCE_CAST, "reference", volume, transfer);
      const Picture oracle = reference.cast(rays);
      const std::vector<std::string> names = instruction_names();
      ASSERT_EQ(names.back(), "scalar");
      for (std::size_t set = 1; set < names.size(); ++set) {
        SCOPED_TRACE(fmt::format("{} {} x {} x {}", names[set], one.dims[0], one.dims[1], one.dims[2]));
        Caster native(NATIVE_CAST, "native", volume, transfer, static_cast<int>(set));
        const Picture picture = native.cast(rays);
        expect_near(picture, oracle);
        EXPECT_LE(picture.counted.rays, std::uint64_t{rays.across} * rays.down);
      }
    }
  }
}

constexpr std::array skip_maps = {BRACE_SKIP_MAP_DISTANCES, BRACE_SKIP_MAP_BITS, BRACE_SKIP_MAP_OCTREE};

TEST(NativeCast, SkippingChangesNoBit) {
  Random random(11);
  std::uint64_t skipped = 0;
  for (int round = 0; round < 40; ++round) {
    const auto type = static_cast<brace_voxel_type>(round % 4);
    const TestTransfer transfer(range_of(type));
    const Case& one = cases[static_cast<std::size_t>(round) % cases.size()];
    const TestVolume volume = random_volume(one.dims, type, random);
    const TestRays rays = random_rays(one.across, one.down, volume, random);
    const Blocks blocks(volume, transfer.visible_above);
    for (std::size_t set = 1; set < instruction_names().size(); ++set) {
      Caster native(NATIVE_CAST, "native", volume, transfer, static_cast<int>(set));
      const Picture plain = native.cast(rays);
      for (const brace_skip_map kind : skip_maps) {
        const Picture leaping = native.cast(rays, blocks.map(kind));
        EXPECT_EQ(leaping.colours, plain.colours) << round << ' ' << kind;
        EXPECT_EQ(leaping.depths_m, plain.depths_m) << round << ' ' << kind;
        EXPECT_LE(leaping.counted.samples, plain.counted.samples);
        skipped += plain.counted.samples - leaping.counted.samples;
      }
    }
  }
  EXPECT_GT(skipped, 1000u);
}

// Rays near to each other go together: another way through the map, and on some processors to the voxels.
TEST(NativeCast, SkippingSideBySideChangesNoBit) {
  Random random(17);
  std::uint64_t skipped = 0;
  constexpr std::array<std::array<std::uint32_t, 3>, 5> sizes{
      {{41, 36, 50}, {64, 64, 64}, {1, 1, 1}, {3, 70, 9}, {13, 5, 2}}};
  for (std::size_t round = 0; round < 20; ++round) {
    const auto type = static_cast<brace_voxel_type>(round % 4);
    const TestTransfer transfer(range_of(type));
    const TestVolume volume = random_volume(sizes[round % sizes.size()], type, random, 0.9995);
    const double spacing = std::array{0.02, 0.3, 0.6, 1.3, 3.0}[random() % 5];
    const double away = std::array{1.0, 20.0, 200.0}[random() % 3];  // 1: an eye in the volume
    const TestRays rays = camera_rays(21, 14, volume, away, spacing, random);
    const Blocks blocks(volume, transfer.visible_above);
    Caster reference(REFERENCE_CAST, "reference", volume, transfer);
    const Picture oracle = reference.cast(rays);
    for (std::size_t set = 1; set < instruction_names().size(); ++set) {
      SCOPED_TRACE(fmt::format("{} {} {} voxels apart", round, instruction_names()[set], spacing));
      Caster native(NATIVE_CAST, "native", volume, transfer, static_cast<int>(set));
      const Picture plain = native.cast(rays);
      expect_near(plain, oracle);
      for (const brace_skip_map kind : skip_maps) {
        const Picture leaping = native.cast(rays, blocks.map(kind));
        EXPECT_EQ(leaping.colours, plain.colours) << kind;
        EXPECT_EQ(leaping.depths_m, plain.depths_m) << kind;
        EXPECT_LE(leaping.counted.samples, plain.counted.samples);
        skipped += plain.counted.samples - leaping.counted.samples;
      }
    }
  }
  EXPECT_GT(skipped, 100'000u);
}

// Where rays end their last samples stand nearer by up to half a step each: the points of a packet lie
// farther apart along the rays than across them.
TEST(NativeCast, LongStepsAndRaysAtTheEdgeOfNearAgreeWithTheReference) {
  Random random(23);
  constexpr std::array<std::array<std::uint32_t, 3>, 4> sizes{
      {{9, 9, 9}, {5, 13, 2}, {40, 3, 2}, {33, 40, 37}}};
  for (std::size_t round = 0; round < 24; ++round) {
    const double step = std::array{0.5, 2.0, 5.0, 12.0, 64.0}[round % 5];
    const auto type = round % 3 == 0 ? static_cast<brace_voxel_type>(round % 4) : BRACE_VOXEL_UINT8;
    const TestTransfer transfer(range_of(type), step);
    const TestVolume volume = random_volume(sizes[round % sizes.size()], type, random, 0.3);
    const double spacing = std::array{0.1, 0.8, 1.0, 1.2, 1.33}[random() % 5];
    const TestRays rays = camera_rays(24, 16, volume, 60.0, spacing, random);
    Caster reference(REFERENCE_CAST, "reference", volume, transfer);
    const Picture oracle = reference.cast(rays);
    for (std::size_t set = 1; set < instruction_names().size(); ++set) {
      SCOPED_TRACE(
          fmt::format("{} {} step {}, {} voxels apart", round, instruction_names()[set], step, spacing));
      Caster native(NATIVE_CAST, "native", volume, transfer, static_cast<int>(set));
      expect_near(native.cast(rays), oracle);
    }
  }
}

TEST(NativeCast, OneLookIntoTheMapServesAPacket) {
  Random random(19);
  const TestTransfer transfer({0, 255});
  const TestVolume volume = random_volume({64, 64, 64}, BRACE_VOXEL_UINT8, random, 0.9995);
  const TestRays rays = camera_rays(64, 64, volume, 150.0, 0.3, random);
  const int scalar = static_cast<int>(instruction_names().size()) - 1;
  for (const brace_skip_map kind : skip_maps) {
    const TestMap map = Blocks(volume, transfer.visible_above).map(kind);
    // One after the other: the choice of instructions is the process's.
    const Picture packets = Caster(NATIVE_CAST, "native", volume, transfer).cast(rays, map);
    const Picture single = Caster(NATIVE_CAST, "native", volume, transfer, scalar).cast(rays, map);
    EXPECT_GT(single.counted.skip_steps, 10'000u);
    EXPECT_LT(packets.counted.skip_steps, single.counted.skip_steps / 2) << kind;
    EXPECT_LT(static_cast<double>(packets.counted.samples), 2.0 * static_cast<double>(single.counted.samples))
        << kind;
  }
}

TEST(NativeCast, WorksOnTheAreaOnly) {
  Random random(3);
  const TestTransfer transfer({0, 255});
  const TestVolume volume = random_volume({12, 12, 12}, BRACE_VOXEL_UINT8, random);
  const TestRays rays = random_rays(11, 9, volume, random);
  Caster native(NATIVE_CAST, "native", volume, transfer);
  const Picture whole = native.cast(rays), part = native.cast(rays, {}, {3, 2, 5, 4});
  for (std::uint32_t y = 0; y < 9; ++y) {
    for (std::uint32_t x = 0; x < 11; ++x) {
      const bool inside = x >= 3 && x < 8 && y >= 2 && y < 6;
      const std::size_t ray = y * 11 + x;
      EXPECT_EQ(part.depths_m[ray], inside ? whole.depths_m[ray] : -7.0f) << x << ' ' << y;
    }
  }
}

TEST(NativeCast, NotANumberIsEmptyAndResultsKeepTheContract) {
  Random random(5);
  const TestTransfer transfer({-1, 1});
  TestVolume volume = random_volume({8, 8, 8}, BRACE_VOXEL_FLOAT32, random);
  std::vector<float> voxels(512, std::numeric_limits<float>::quiet_NaN());
  voxels[100] = std::numeric_limits<float>::infinity();
  voxels[200] = -std::numeric_limits<float>::infinity();
  std::memcpy(volume.bytes.data(), voxels.data(), volume.bytes.size());
  const TestRays rays = random_rays(16, 16, volume, random);
  for (const brace_shading shading :
       {BRACE_SHADING_NONE, BRACE_SHADING_PHONG, BRACE_SHADING_SHADOW_AO, BRACE_SHADING_RANDOM_LIGHTS}) {
    Caster native(NATIVE_CAST, "native", volume, transfer, -1, shading);
    const Picture picture = native.cast(rays);
    for (std::size_t ray = 0; ray < picture.depths_m.size(); ++ray) {
      const float* colour = &picture.colours[4 * ray];
      for (int c = 0; c < 3; ++c)
        EXPECT_TRUE(colour[c] >= 0.0f && colour[c] <= colour[3] && colour[3] <= 1.0f) << ray;
    }
  }
}

TEST(NativeCast, EveryInstructionSetIsLitAlikeByAdditionalSamples) {
  Random random(13);
  const TestTransfer transfer({0, 255});
  const TestVolume volume = random_volume({17, 16, 21}, BRACE_VOXEL_UINT8, random);
  const TestRays rays = random_rays(16, 9, volume, random);
  const std::vector<std::string> names = instruction_names();
  for (const brace_shading shading : {BRACE_SHADING_SHADOW_AO, BRACE_SHADING_RANDOM_LIGHTS}) {
    Caster scalar(NATIVE_CAST, "native", volume, transfer, static_cast<int>(names.size()) - 1, shading);
    const Picture oracle = scalar.cast(rays);
    EXPECT_EQ(oracle.counted.shading_fetches % (shading == BRACE_SHADING_SHADOW_AO ? 38 : 18), 0u);
    EXPECT_GT(oracle.counted.shading_fetches, 0u);
    for (std::size_t set = 1; set + 1 < names.size(); ++set) {
      SCOPED_TRACE(names[set]);
      Caster native(NATIVE_CAST, "native", volume, transfer, static_cast<int>(set), shading);
      const Picture picture = native.cast(rays);
      expect_near(picture, oracle);
      EXPECT_EQ(picture.counted.shading_fetches, oracle.counted.shading_fetches);
    }
  }
}

TEST(NativeCast, ShadingFetchesSixPerVisibleSample) {
  Random random(9);
  const TestTransfer transfer({0, 255});
  const TestVolume volume = random_volume({16, 16, 16}, BRACE_VOXEL_UINT8, random);
  const TestRays rays = random_rays(16, 16, volume, random);
  Caster plain(NATIVE_CAST, "native", volume, transfer);
  Caster lit(NATIVE_CAST, "native", volume, transfer, -1, BRACE_SHADING_PHONG);
  const Picture unlit = plain.cast(rays), shaded = lit.cast(rays);
  EXPECT_EQ(unlit.counted.shading_fetches, 0u);
  EXPECT_GT(shaded.counted.shading_fetches, 0u);
  EXPECT_EQ(shaded.counted.shading_fetches % 6, 0u);
  EXPECT_EQ(shaded.counted.samples, unlit.counted.samples);
  EXPECT_EQ(shaded.depths_m, unlit.depths_m);
  EXPECT_NE(shaded.colours, unlit.colours);
}

}  // namespace
}  // namespace brace
