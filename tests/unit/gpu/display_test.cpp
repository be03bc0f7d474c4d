#include <algorithm>

#include "gpu/display_reference.hpp"
#include "hmd_sim/device_profile.hpp"

namespace brace {
namespace {

class Display : public gpu::GpuTest {};

std::vector<sim::DeviceProfile> profiles_with_lens() {
  auto profiles = sim::list_device_profiles(std::filesystem::path(BRACE_SOURCE_DIR) / "hmd_sim/profiles");
  std::erase_if(profiles, [](const auto& profile) { return !profile.has_lens_data(); });
  return profiles;
}

PanelEye panel_of(const sim::DeviceProfile& profile, sim::Eye eye, int width_px, int height_px) {
  return {width_px, height_px, profile.eye(eye).lens, profile.eye(eye).fov};
}

// A lens of each model whose channels share polynomial and centre.
PanelEye grey_panel(sim::LensKind kind) {
  PanelEye eye{150, 160, {}, {-1.1, 0.9, -1.0, 1.2}};
  eye.lens.kind = kind;
  eye.lens.panel_size_units = {1.9, 2.0};
  eye.lens.tan_per_unit = {0.8, 0.85};
  eye.lens.cutoff_radius = 1.1;
  for (sim::LensChannel& channel : eye.lens.rgb) {
    channel.centre_uv = {0.53, 0.48};
    switch (kind) {
      case sim::LensKind::panotools:
        channel.k = {0.9, 0.02, 0.05, -0.01, 0.03};
        break;
      case sim::LensKind::vive:
        channel.k = {-0.2, -0.05, -0.02, 0.03, 0.0};
        break;
      case sim::LensKind::brown_conrady:
        channel.k = {0.2, 0.1, 0.02, 0.0, 0.0};
        break;
      default:
        break;
    }
  }
  return eye;
}

const std::vector<sim::LensKind> all_kinds{sim::LensKind::identity, sim::LensKind::brown_conrady,
                                           sim::LensKind::panotools, sim::LensKind::vive};

TEST_F(Display, EveryProfileMatchesTheDoubleReferenceInBothEyes) {
  const auto profiles = profiles_with_lens();
  ASSERT_GE(profiles.size(), 3u);
  for (const sim::DeviceProfile& profile : profiles)
    for (const sim::Eye which : sim::all_eyes) {
      const PanelEye eye = panel_of(profile, which, 90, 100);
      const Picture picture = noise_picture(125, 140, eye.fov);
      const auto shown = DisplayRun{device()}.show(eye, picture);
      expect_like_reference(shown.image, eye, picture, no_warp(), profile.name);
    }
}

TEST_F(Display, EveryLensModelMatchesTheDoubleReferenceWithOneFetchAndWithThree) {
  for (const sim::LensKind kind : all_kinds) {
    const PanelEye eye = grey_panel(kind);
    const Picture picture = noise_picture(201, 177, eye.fov);
    const auto one = DisplayRun{device()}.show(eye, picture);
    expect_like_reference(one.image, eye, picture, no_warp(), std::string(sim::to_string(kind)));
    for (const bool one_centre : {false, true}) {
      DisplayRun run{device()};
      run.traits = LensTraits{kind, one_centre, false};
      EXPECT_EQ(run.show(eye, picture).image.pixels, one.image.pixels) << sim::to_string(kind);
    }
  }
}

TEST_F(Display, AnIdentityLensAtEqualSizeCopiesThePicture) {
  const sim::FovTangents fov{-1.3, 0.9, -1.1, 1.2};
  const PanelEye eye{64, 48, sim::identity_lens(fov), fov};
  const Picture picture = noise_picture(64, 48, fov);
  const auto shown = DisplayRun{device()}.show(eye, picture);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const Rgba8 pixel = shown.image.at(x, y);
      ASSERT_EQ(pixel.r, picture.value(x, y, 0)) << x << ", " << y;
      ASSERT_EQ(pixel.g, picture.value(x, y, 1));
      ASSERT_EQ(pixel.b, picture.value(x, y, 2));
      ASSERT_EQ(pixel.a, 255);
    }
}

TEST_F(Display, HiddenTilesAreLeftOutWithoutChangingThePicture) {
  PanelEye eye = grey_panel(sim::LensKind::vive);
  eye.width_px = eye.height_px = 300;
  eye.lens.cutoff_radius = 0.8;
  const Picture picture = noise_picture(200, 200, eye.fov);
  const auto sparse = DisplayRun{device()}.show(eye, picture);
  DisplayRun everything{device()};
  everything.skip_hidden = false;
  const auto whole = everything.show(eye, picture);
  EXPECT_EQ(sparse.image.pixels, whole.image.pixels);
  EXPECT_EQ(whole.pixels_written, 300u * 300u);
  EXPECT_LT(sparse.pixels_written, whole.pixels_written * 9 / 10);
}

TEST_F(Display, APanelWithNothingToSeeStaysBlack) {
  PanelEye eye = grey_panel(sim::LensKind::identity);
  eye.fov = {5.0, 6.0, 5.0, 6.0};
  const auto shown = DisplayRun{device()}.show(eye, noise_picture(20, 20, eye.fov));
  EXPECT_EQ(shown.pixels_written, 0u);
  for (const Rgba8& pixel : shown.image.pixels)
    ASSERT_EQ(pixel, (Rgba8{0, 0, 0, 255}));
}

// Instructions of one kind in a module.
int count_ops(const std::vector<std::uint32_t>& spirv, std::uint32_t op) {
  int count = 0;
  for (std::size_t at = 5; at < spirv.size(); at += spirv[at] >> 16)
    count += (spirv[at] & 0xffff) == op;
  return count;
}

TEST(DisplayKernel, HoldsOnlyWhatTheLensNeeds) {
  const std::filesystem::path root = BRACE_SOURCE_DIR;
  DisplayParts parts;
  parts.glsl_folder = root / "plugins/abi/glsl";
  parts.kernels_folder = root / "runtime/display/kernels";
  parts.stages = [&](std::string_view name) -> std::optional<gpu::GlslSource> {
    if (name == "stage/warp.glsl") return gpu::read_glsl(root / "stages/warp/none/none.glsl");
    return name == "stage/parameters.glsl" ? std::optional(gpu::GlslSource{"none", ""}) : std::nullopt;
  };
  const auto spirv = [&](LensTraits lens, bool counters) {
    parts.lens = lens;
    parts.counters = counters;
    return gpu::compile(compose_display_kernel(parts), {.use_cache = false, .cache_folder = {}}).spirv;
  };
  constexpr std::uint32_t op_div = 136, op_atomic_add = 234;
  const auto distorting = spirv({sim::LensKind::vive, true, false}, false);
  const auto grey = spirv({sim::LensKind::identity, true, true}, false);
  EXPECT_GT(count_ops(distorting, op_div), 0);
  EXPECT_EQ(count_ops(grey, op_div), 0);
  EXPECT_EQ(count_ops(grey, op_atomic_add), 0);
  EXPECT_GT(count_ops(spirv({sim::LensKind::identity, true, true}, true), op_atomic_add), 0);
}

TEST(DisplayGeometry, WhatCannotBeShownIsBadInput) {
  const PanelEye eye = grey_panel(sim::LensKind::identity);
  const SourcePicture good{20, 20, eye.fov};
  EXPECT_NO_THROW((void)display_params(eye, good));
  PanelEye empty = eye;
  empty.width_px = 0;
  EXPECT_THROW((void)display_params(empty, good), Error);
  EXPECT_THROW((void)display_params(eye, {1, 20, eye.fov}), Error);
  EXPECT_THROW((void)display_params(eye, {20, 20, {1, -1, -1, 1}}), Error);
  BraceDisplayParams params = display_params(eye, good);
  Pose lost;
  lost.position.x = std::nan("");
  EXPECT_THROW(set_poses(params, {}, lost), Error);
  EXPECT_THROW((void)common_traits({sim::LensKind::vive, true, true}, {sim::LensKind::identity, true, true}),
               Error);
  EXPECT_EQ(common_traits({sim::LensKind::vive, true, true}, {sim::LensKind::vive, true, false}),
            (LensTraits{sim::LensKind::vive, true, false}));
}

}  // namespace
}  // namespace brace
