// Coarser levels of the volume, and cast/dvr's level of detail on them.
#include <algorithm>
#include <numeric>
#include <random>

#include "runtime/raycast/volume_levels.hpp"
#include "runtime/replay/cast_integrator.hpp"
#include "tests/unit/accelerations/eye_rig.hpp"

namespace brace {
namespace {

VolumeInfo volume_of(std::array<int, 3> dims) {
  VolumeInfo info;
  info.dims = dims;
  return info;
}

/// All levels of a volume given by its values, x fastest.
std::vector<std::vector<double>> levels_of(const VolumeInfo& info, const std::vector<double>& values) {
  std::vector<std::vector<double>> levels(static_cast<std::size_t>(coarser_levels(info)) + 1);
  LevelBuilder builder(info, [&](int level, int z, std::span<const double> slice) {
    auto& to = levels[static_cast<std::size_t>(level)];
    EXPECT_EQ(to.size(), slice.size() * static_cast<std::size_t>(z)) << "slices come in order";
    to.insert(to.end(), slice.begin(), slice.end());
  });
  const std::size_t slice = static_cast<std::size_t>(info.dims[0]) * static_cast<std::size_t>(info.dims[1]);
  for (std::size_t z = 0; z < static_cast<std::size_t>(info.dims[2]); ++z)
    builder.add(std::span(values).subspan(z * slice, slice));
  return levels;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST(Levels, EdgesHalveUntilFourVoxelsAreLeft) {
  EXPECT_EQ(coarser_levels(volume_of({7, 64, 64})), 0);
  EXPECT_EQ(coarser_levels(volume_of({8, 64, 64})), 1);
  EXPECT_EQ(coarser_levels(volume_of({33, 35, 47})), 3);
  EXPECT_EQ(level_dims(volume_of({33, 35, 47}), 3), (std::array{4, 4, 5}));
  EXPECT_EQ(coarser_levels(volume_of({4096, 4096, 4096})), 8);
}

TEST(Levels, AnEvenEdgeHasMeansOfEight) {
  const VolumeInfo info = volume_of({8, 8, 8});
  std::vector<double> values(512);
  std::iota(values.begin(), values.end(), 0.0);
  const auto levels = levels_of(info, values);
  ASSERT_EQ(levels[1].size(), 64u);
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x)
        EXPECT_DOUBLE_EQ(levels[1][static_cast<std::size_t>(x + 4 * (y + 4 * z))],
                         2 * x + 0.5 + 8 * (2 * y + 0.5) + 64 * (2 * z + 0.5));
}

TEST(Levels, OddEdgesKeepMeansConstantsBoundsAndRamps) {
  const VolumeInfo info = volume_of({37, 19, 23});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-3.0, 5.0);
  std::vector<double> noise(37 * 19 * 23), ramp(noise.size());
  for (std::size_t i = 0; i < noise.size(); ++i) {
    noise[i] = unit(random);
    const auto x = static_cast<double>(i % 37), y = static_cast<double>(i / 37 % 19),
               z = static_cast<double>(i / 37 / 19);
    ramp[i] = (x + 0.5) / 37 + 2.0 * (y + 0.5) / 19 - 3.0 * (z + 0.5) / 23;
  }
  const auto [low, high] = std::minmax_element(noise.begin(), noise.end());
  const auto noisy = levels_of(info, noise);
  const auto constant = levels_of(info, std::vector<double>(noise.size(), 7.25));
  const auto sloped = levels_of(info, ramp);
  const double slope = 1.0 / 37 + 2.0 / 19 + 3.0 / 23;
  ASSERT_EQ(noisy.size(), 3u);
  for (int level = 1; level <= 2; ++level) {
    const auto at = static_cast<std::size_t>(level);
    const auto dims = level_dims(info, level);
    EXPECT_NEAR(mean(noisy[at]), mean(noise), 1e-12);
    for (std::size_t i = 0; i < noisy[at].size(); ++i) {
      EXPECT_GE(noisy[at][i], *low);
      EXPECT_LE(noisy[at][i], *high);
      EXPECT_NEAR(constant[at][i], 7.25, 1e-12);
    }
    // At its middle a voxel of a level has the ramp's value but for the voxels that boxes cut: these count as
    // constant, which is off by at most an eighth of the slope per voxel.
    for (std::size_t i = 0; i < sloped[at].size(); ++i) {
      const auto x = static_cast<double>(i % static_cast<std::size_t>(dims[0]));
      const auto y =
          static_cast<double>(i / static_cast<std::size_t>(dims[0]) % static_cast<std::size_t>(dims[1]));
      const auto z = static_cast<double>(i / static_cast<std::size_t>(dims[0] * dims[1]));
      EXPECT_NEAR(sloped[at][i], (x + 0.5) / dims[0] + 2.0 * (y + 0.5) / dims[1] - 3.0 * (z + 0.5) / dims[2],
                  slope / 8.0);
    }
  }
}

class LevelOfDetail : public gpu::GpuTest {
 protected:
  static Session with_lod(const std::string& volume, const std::string& transfer, const char* lod,
                          double bias, const char* skip = "none") {
    Session session = accelerations_session(volume, transfer, skip);
    EXPECT_TRUE(session.pipeline.at("cast").set_choice("lod", lod) &&
                session.pipeline.at("cast").set("lod_bias", bias));
    return session;
  }
};

int largest_difference(const std::vector<Rgba8>& a, const std::vector<Rgba8>& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (const int off : {a[i].r - b[i].r, a[i].g - b[i].g, a[i].b - b[i].b, a[i].a - b[i].a})
      most = std::max(most, std::abs(off));
  return most;
}

TEST_F(LevelOfDetail, TheFinestLevelIsThePictureWithoutBitForBit) {
  for (const char* volume : {"generator:nested_shells:40", "generator:nested_shells:24x33x30:int16",
                             "generator:marschner_lobb:24:float32"})
    for (const char* path : {"auto", "sampler"}) {
      SCOPED_TRACE(std::string(volume) + ", " + path);
      Session off = accelerations_session(volume, upper_half());
      Session finest = with_lod(volume, upper_half(), "mip-linear", -8.0);
      off.scene.data_path = finest.scene.data_path = path;
      AccelerationsRig a(device(), off), b(device(), finest);
      EXPECT_EQ(a.render(Pose{}).samples, b.render(Pose{}).samples);
      EXPECT_EQ(a.picture(), b.picture());
    }
}

TEST_F(LevelOfDetail, AHomogeneousVolumeLooksTheSameAtEveryLevelInEveryLayout) {
  for (const char* type : {"uint8", "int16", "uint16", "float32"})
    for (const char* path : {"auto", "sampler"}) {
      SCOPED_TRACE(std::string(type) + ", " + path);
      const std::string volume = std::string("generator:slab:40x33x35:") + type;
      // Domain "fraction": of a range that a constant does not have, so by an absolute one.
      Session off = accelerations_session(volume, "tf1");
      Session coarse = with_lod(volume, "tf1", "mip", 1.0);
      off.scene.data_path = coarse.scene.data_path = path;
      AccelerationsRig a(device(), off), b(device(), coarse);
      const std::uint64_t fine_samples = a.render(Pose{}).samples;
      EXPECT_LT(b.render(Pose{}).samples, fine_samples / 2);
      EXPECT_LE(largest_difference(a.left_pixels(), b.left_pixels()), 1);
      const auto alpha = [](const Rgba8& pixel) { return pixel.a > 0; };
      const auto pixels = b.left_pixels();
      EXPECT_TRUE(std::any_of(pixels.begin(), pixels.end(), alpha));
    }
}

TEST_F(LevelOfDetail, SkippingChangesNoBit) {
  const Pose heads[] = {Pose{}, moved_head(0.1, 0, 1.5), moved_head(0.02, 0.03, -0.7)};
  for (const char* lod : {"mip", "mip-linear"}) {
    // Hard edges in empty space, whose coarse levels reach into what is empty. One volume each, as kernels
    // take longer to compile than to run.
    const char* volume = lod[3] == '-' ? "generator:fractal_vessels:48" : "generator:solid_box:64";
    AccelerationsRig plain(device(), with_lod(volume, "tf1", lod, 0.0));
    for (const char* skip : {"distance_map", "octree", "block"}) {
      SCOPED_TRACE(std::string(volume) + ", " + lod + ", " + skip);
      AccelerationsRig skipping(device(), with_lod(volume, "tf1", lod, 0.0, skip));
      std::uint64_t all = 0, some = 0;
      for (const Pose& head : heads) {
        all += plain.render(head).samples;
        some += skipping.render(head).samples;
        EXPECT_EQ(skipping.picture(), plain.picture());
      }
      if (std::string(skip) == "distance_map") {
        EXPECT_LT(some, all);
      } else {
        EXPECT_LE(some, all);
      }
    }
  }
}

TEST_F(LevelOfDetail, FirstHitsOfTheLastFrameChangeNoBit) {
  AccelerationsRig plain(device(), with_lod("generator:nested_shells:64", upper_half(), "mip", 0.0));
  AccelerationsRig leaping(device(),
                           with_lod("generator:nested_shells:64", upper_half(), "mip", 0.0, "occlusion"));
  for (int frame = 0; frame < 3; ++frame) {
    const Pose head = moved_head(0.004 * frame, 0, 0, 0.01 * frame);
    const std::uint64_t all = plain.render(head).samples;
    const std::uint64_t some = leaping.render(head).samples;
    EXPECT_EQ(leaping.picture(), plain.picture());
    EXPECT_EQ(some<all, frame> 0);
  }
}

TEST_F(LevelOfDetail, FartherAndCoarserTakesFewerSamplesAndStaysInBounds) {
  std::uint64_t before = 0;
  for (const double bias : {-8.0, 0.0, 1.0, 2.0, 8.0}) {
    AccelerationsRig rig(device(), with_lod("generator:nested_shells:64", "tf1", "mip", bias));
    const std::uint64_t samples = rig.render(Pose{}).samples;
    if (before > 0) {
      EXPECT_LE(samples, before) << bias;
    }
    before = samples;
    for (const Pose& head : {Pose{}, moved_head(0, 0, -0.8), moved_head(0, 0, 40.0)}) {
      rig.render(head);
      for (const Rgba8& pixel : rig.left_pixels())
        EXPECT_LE(std::max({pixel.r, pixel.g, pixel.b}), pixel.a + 1);
    }
  }
  const auto samples_at = [&](double back_m, const char* lod) {
    AccelerationsRig rig(device(), with_lod("generator:nested_shells:64", "tf1", lod, 0.0));
    const WorkCounts work = rig.render(moved_head(0, 0, back_m));
    return static_cast<double>(work.samples);
  };
  EXPECT_LT(samples_at(2.0, "mip") / samples_at(2.0, "off"),
            0.6 * samples_at(-0.4, "mip") / samples_at(-0.4, "off"));
}

TEST_F(LevelOfDetail, AVolumeWithoutLevelsIsSampledItself) {
  AccelerationsRig off(device(), accelerations_session("generator:nested_shells:7x30x30", upper_half()));
  AccelerationsRig lod(device(),
                       with_lod("generator:nested_shells:7x30x30", upper_half(), "mip-linear", 4.0));
  off.render(Pose{});
  lod.render(Pose{});
  EXPECT_EQ(lod.picture(), off.picture());
  EXPECT_NE(lod.scene->levels->summary().find("none"), std::string::npos);
}

TEST_F(LevelOfDetail, WhatHasStepsOfItsOwnIsRefusedByName) {
  const auto message = [](const auto& change) -> std::string {
    PipelineStage cast = accelerations_stage("cast", "dvr");
    EXPECT_TRUE(cast.set_choice("lod", "mip"));
    change(cast);
    try {
      (void)transfer_extras(cast);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([](PipelineStage&) {}), "");
  EXPECT_NE(message([](PipelineStage& cast) { cast.set("tolerance", 0.01); }).find("tolerance"),
            std::string::npos);
  EXPECT_NE(message([](PipelineStage& cast) { cast.set_choice("integrator", "left"); }).find("integrator"),
            std::string::npos);
}

}  // namespace
}  // namespace brace
