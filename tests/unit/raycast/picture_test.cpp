// Pictures of the kernels against the double-precision reference.
#include <gmock/gmock.h>

#include "runtime/volume/generators.hpp"
#include "runtime/volume/statistics.hpp"
#include "tests/unit/raycast/raycast_fixture.hpp"

namespace brace {
namespace {

constexpr double kMax = 1.0 / 255.0;
constexpr double kRms = 1e-3;

class Picture : public RaycastTest {
 protected:
  void expect_like_reference(const Volume& volume, const TransferTable& table, const EyeView& eye,
                             const VolumePlacement& placement, const CastSettings& settings,
                             VolumePath path) {
    const Shot shot = shoot(volume, table, eye, placement, settings, path);
    const auto expected = reference::render(volume, table, eye, placement, reference_options(settings));
    const Difference found = difference(shot.colours, expected);
    EXPECT_LE(found.max, kMax) << volume.info.source << " " << to_string(path);
    EXPECT_LE(found.rms, kRms) << volume.info.source << " " << to_string(path);
    const auto visible = [](const glm::dvec4& c) { return c.a > 0.02; };
    EXPECT_TRUE(std::any_of(expected.colours.begin(), expected.colours.end(), visible))
        << "an empty picture proves nothing";
  }
};

VolumePlacement tilted() {
  VolumePlacement placement;
  placement.world_from_volume.orientation = quat_exp({0.3, 0.5, -0.2});
  return placement;
}

TEST_F(Picture, OfEveryGeneratorMatchesTheReference) {
  const EyeView eye = look_at_centre({0.3, 0.2, 2.0});
  for (const GeneratorInfo& generator : generators()) {
    const Volume volume = load("generator:" + generator.name + ":48x40x44");
    const TransferTable table = smooth_table(volume, {0.0, full_scale(volume.info.type)});
    for (const VolumePath path : {VolumePath::packed, VolumePath::sampler}) {
      expect_like_reference(volume, table, eye, tilted(), {}, path);
    }
  }
}

TEST_F(Picture, OfEveryVoxelTypeAndSpacingMatchesTheReference) {
  const EyeView eye = look_at_centre({-0.5, 0.7, 1.6}, 48, 40);
  for (const char* type : {"uint8", "int16", "uint16", "float32"}) {
    Volume volume = load(std::string("generator:marschner_lobb:32x30x17:") + type);
    volume.info.spacing = {0.5, 0.75, 1.25};
    const ValueRange range = scan(volume).range;
    const TransferTable table = smooth_table(volume, range);
    for (const VolumePath path : {VolumePath::packed, VolumePath::sampler}) {
      expect_like_reference(volume, table, eye, tilted(), {}, path);
      // Lit kernels take long to compile on a software device: the two ends will do.
      if (volume.info.type == VoxelType::int16 || volume.info.type == VoxelType::uint16) continue;
      CastSettings phong;
      phong.phong = true;
      expect_like_reference(volume, table, eye, tilted(), phong, path);
    }
  }
}

TEST_F(Picture, LitByAdditionalSamplesMatchesTheReference) {
  const EyeView eye = look_at_centre({-0.5, 0.7, 1.6}, 32, 32);
  Volume volume = load("generator:nested_shells:24x20x17");
  volume.info.spacing = {0.5, 0.75, 1.25};
  const TransferTable table = smooth_table(volume, scan(volume).range);
  CastSettings settings;
  settings.shadow_ao = true;
  expect_like_reference(volume, table, eye, tilted(), settings, VolumePath::packed);
  settings.shadow_ao = false;
  // No sample at all, less than a light's four, one light, several with a part of one, all.
  for (const int samples : {0, 3, 4, 18, 64}) {
    settings.light_samples = samples;
    expect_like_reference(volume, table, eye, tilted(), settings, VolumePath::packed);
  }
  settings.integrator = "linear-source";
  settings.light_samples = 5;
  expect_like_reference(volume, table, eye, tilted(), settings, VolumePath::sampler);
}

TEST_F(Picture, AdditionalSamplesAreCountedPerVisibleSample) {
  const Volume volume = load("generator:nested_shells:24");
  const TransferTable table = smooth_table(volume, scan(volume).range);
  const EyeView eye = look_at_centre({0.3, 0.2, 2.0}, 24, 24);
  const auto fetches = [&](const CastSettings& settings) {
    return shoot(volume, table, eye, tilted(), settings).work.shading_fetches;
  };
  CastSettings four, all, none, shadow;
  four.light_samples = 4;
  all.light_samples = 64;
  none.light_samples = 0;
  shadow.shadow_ao = true;
  const std::uint64_t visible = fetches(four) / 4;
  EXPECT_GT(visible, 1000u);
  EXPECT_EQ(fetches(four), 4 * visible);
  EXPECT_EQ(fetches(all), 64 * visible);
  EXPECT_EQ(fetches(none), 0u);
  EXPECT_EQ(fetches(shadow), 38 * visible);
}

TEST_F(Picture, SamplerAndPackedPathAgreeOnAllVoxelsInAllShadings) {
  const EyeView eye = look_at_centre({0.4, -0.3, 1.5});
  CastSettings phong, lights, shadow;
  phong.phong = true;
  lights.light_samples = 4;
  shadow.shadow_ao = true;
  for (const char* name : {"generator:marschner_lobb:40", "generator:fractal_vessels:40:int16",
                           "generator:marschner_lobb:40:uint16", "generator:fractal_vessels:40:float32"}) {
    const Volume volume = load(name);
    const TransferTable table = smooth_table(volume, {0.0, full_scale(volume.info.type)});
    for (const CastSettings& settings : {CastSettings{}, phong, lights, shadow}) {
      const Shot packed = shoot(volume, table, eye, tilted(), settings, VolumePath::packed);
      const Shot sampled = shoot(volume, table, eye, tilted(), settings, VolumePath::sampler);
      const Difference found = difference(packed.colours, sampled.colours);
      EXPECT_LE(found.max, kMax) << name << (settings.phong ? ", phong" : "") << settings.light_samples;
      EXPECT_LE(found.rms, kRms) << name;
    }
  }
}

TEST_F(Picture, OfEveryRealVolumeMatchesTheReference) {
  const auto folder = shared_volumes();
  if (folder.empty()) GTEST_SKIP() << "no real volumes: set BRACE_SHARED_DIR";
  const EyeView eye = look_at_centre({0.6, 0.5, 1.6}, 40, 40);
  for (const char* name : {"angio_aneurism_256x256x256_u8.nrrd", "ct_bonsai_256x256x256_u8.nrrd",
                           "ct_carp_256x512x256_u8.nii.gz", "ct_cranium_256x256x108_i16.nrrd",
                           "mri_colin27_ch2better_301x370x316_u8.nii.gz", "tooth.nhdr"}) {
    const Volume volume = load(folder / name);
    const ValueRange range = scan(volume).range;
    expect_like_reference(volume, smooth_table(volume, range), eye, tilted(), {}, VolumePath::automatic);
  }
}

TEST_F(Picture, OfTheBrainWithItsPresetMatchesTheReference) {
  const auto folder = shared_volumes();
  if (folder.empty()) GTEST_SKIP() << "no real volumes: set BRACE_SHARED_DIR";
  const Volume volume = load(folder / "mri_colin27_ch2better_301x370x316_u8.nii.gz");
  const auto function = load_transfer_function("mri-brain", preset_folder());
  const TransferTable table =
      bake(resolve(function, {0.0, 130.0}), table_layout(VoxelType::uint8, {0.0, 130.0}));
  CastSettings lit;
  lit.phong = true;
  for (const CastSettings& settings : {CastSettings{}, lit}) {
    expect_like_reference(volume, table, look_at_centre({0.6, 0.5, 1.6}, 40, 40), tilted(), settings,
                          VolumePath::packed);
  }
}

TEST_F(Picture, DepthIsTheDistanceOfTheFirstVisibleSample) {
  const Volume volume = load("generator:nested_shells:40");
  const TransferTable table = smooth_table(volume, {0.0, 255.0});
  VolumePlacement placement = tilted();
  placement.size_m = 0.5;
  const EyeView eye = look_at_centre({0.2, 0.1, 0.9}, 48, 48);
  const Shot shot = shoot(volume, table, eye, placement);
  const auto expected = reference::render(volume, table, eye, placement, {});
  const double step_m = 0.5 * metres_per_unit(volume.info, placement);
  int hits = 0;
  int off_by_a_step = 0;
  for (std::size_t i = 0; i < shot.depths_m.size(); ++i) {
    ASSERT_EQ(std::isinf(shot.depths_m[i]), std::isinf(expected.depths_m[i])) << i;
    ASSERT_EQ(shot.depths_m[i], shot.image_depths_m[i]) << "the full-rate closing brace copies";
    if (std::isinf(shot.depths_m[i])) continue;
    ++hits;
    const double error = std::abs(shot.depths_m[i] - expected.depths_m[i]);
    if (error > 1e-4 * step_m) ++off_by_a_step;  // rounding may see the first sample one step sooner or later
    EXPECT_LE(error, 1.01 * step_m);
  }
  EXPECT_GT(hits, 400);
  EXPECT_LE(off_by_a_step, hits / 50);
}

TEST_F(Picture, OfTheEyeIsTheRoundedPremultipliedColour) {
  const Volume volume = load("generator:marschner_lobb:24");
  const EyeView eye = look_at_centre({0.2, 0.1, 1.7}, 33, 21);
  const Shot shot = shoot(volume, smooth_table(volume, {0.0, 255.0}), eye, tilted());
  for (std::size_t i = 0; i < shot.image.size(); ++i) {
    for (int c = 0; c < 4; ++c) {
      const int byte = static_cast<int>(shot.image[i] >> (8 * c) & 255u);
      EXPECT_NEAR(byte, 255.0 * static_cast<double>(shot.colours[i][c]), 0.5001);
    }
  }
}

TEST_F(Picture, CastInCellsIsThePictureCastWhole) {
  const Volume volume = load("generator:marschner_lobb:24");
  const TransferTable table = smooth_table(volume, {0.0, 255.0});
  const EyeView eye = look_at_centre({0.2, 0.1, 1.7}, 37, 29);
  const Shot whole = shoot(volume, table, eye, tilted());
  const VolumeOnDevice on = on_device(volume);
  const CastPipeline& cast = pipeline(on, {});
  const TransferOnDevice transfer(device(), table, 0.5);
  const RayBuffers rays(device(), 37, 29);
  const EyeTarget target(device(), 37, 29);
  CastPipeline::set_eye(device(), target, eye, tilted(), on, transfer);
  const CastPipeline::Resources resources{on, transfer, rays, target};
  gpu::CommandList commands(device(), "cells");
  cast.record_opening(commands, resources, {0, 0, 37, 29});
  commands.barrier();
  for (int y = 0; y < 29; y += 10) {
    for (int x = 0; x < 37; x += 13) {
      cast.record_cast(commands, resources, {x, y, std::min(13, 37 - x), std::min(10, 29 - y)});
    }
  }
  commands.barrier();
  gpu::submit_and_wait(commands);
  std::vector<glm::vec4> colours(37 * 29);
  gpu::download_values(device(), rays.colours, std::span(colours));
  EXPECT_EQ(difference(whole.colours, colours).max, 0.0);
}

}  // namespace
}  // namespace brace
