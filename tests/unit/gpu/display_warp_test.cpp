#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "gpu/display_reference.hpp"

namespace brace {
namespace {

class Warp : public gpu::GpuTest {
 protected:
  DisplayRun quad(const Pose& old_eye, const Pose& new_eye) const {
    DisplayRun run{device()};
    run.warp = "quad";
    run.world_from_old_eye = old_eye;
    run.world_from_new_eye = new_eye;
    return run;
  }
};

PanelEye panel() {
  PanelEye eye{140, 150, {}, {-1.2, 1.0, -1.1, 1.1}};
  eye.lens.kind = sim::LensKind::vive;
  eye.lens.panel_size_units = {2.0, 2.1};
  eye.lens.tan_per_unit = {0.75, 0.75};
  eye.lens.cutoff_radius = 1.2;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    eye.lens.rgb[channel].k = {-0.2 - 0.01 * static_cast<double>(channel), -0.05, -0.02, 0.0, 0.0};
    eye.lens.rgb[channel].centre_uv = {0.52, 0.5 + 0.001 * static_cast<double>(channel)};
  }
  return eye;
}

TEST_F(Warp, QuadMatchesTheDoubleReference) {
  const PanelEye eye = panel();
  const Picture picture = noise_picture(200, 190, eye.fov);
  const std::pair<Pose, Pose> poses[] = {{turned(0.3, 0.1), turned(0.33, 0.08)},
                                         {turned(-2.0, 0.5, {1, 2, 3}), turned(-1.9, 0.45, {1.2, 2.1, 2.9})},
                                         {turned(0, 0), turned(0.9, -0.3, {0.5, 0, 0})}};
  for (const auto& [old_eye, new_eye] : poses)
    for (const double far_plane_m : {2.0, 100.0}) {
      DisplayRun run = quad(old_eye, new_eye);
      run.parameters["far_plane_m"] = far_plane_m;
      expect_like_reference(run.show(eye, picture).image, eye, picture,
                            quad_warp(old_eye, new_eye, far_plane_m),
                            "far plane " + std::to_string(far_plane_m));
    }
}

TEST_F(Warp, QuadWithoutMotionEqualsNone) {
  const PanelEye eye = panel();
  const Picture picture = noise_picture(200, 190, eye.fov);
  const Pose pose = turned(1.0, -0.4, {3, 1, 2});
  expect_like_reference(quad(pose, pose).show(eye, picture).image, eye, picture, no_warp(), "equal poses");
}

TEST_F(Warp, QuadUnderPureRotationShowsWhatTheNewPoseWouldSee) {
  const PanelEye eye = panel();
  const Pose old_eye = turned(0.4, 0.1, {1, 1, 1}), new_eye = turned(0.52, 0.03, {1, 1, 1});
  const Picture picture = directional_picture(800, 800, eye.fov, old_eye);
  const ImageRgba8 shown = quad(old_eye, new_eye).show(eye, picture).image;
  const PanelReference reference(eye, picture, quad_warp(old_eye, new_eye, 100.0));
  const double usable[] = {sim::usable_radius(eye.lens, sim::Channel::red),
                           sim::usable_radius(eye.lens, sim::Channel::green),
                           sim::usable_radius(eye.lens, sim::Channel::blue)};
  int compared = 0;
  for (int y = 0; y < eye.height_px; ++y)
    for (int x = 0; x < eye.width_px; ++x)
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const ReferencePixel covered = reference.at(channel, x, y);
        if (!covered.covered || covered.on_edge) continue;
        const auto which = static_cast<sim::Channel>(channel);
        const auto tangents = sim::panel_to_tangents(eye.lens, which, usable[channel],
                                                     {(x + 0.5) / eye.width_px, (y + 0.5) / eye.height_px});
        const double expected = directional_value(new_eye.orientation * glm::dvec3(*tangents, -1.0), channel);
        const Rgba8 pixel = shown.at(x, y);
        const std::uint8_t values[] = {pixel.r, pixel.g, pixel.b};
        // Two roundings to 8 bits, and bilinear error h^2/8 |f''| < 0.01 at this resolution.
        ASSERT_NEAR(values[channel], expected, 1.02) << x << ", " << y;
        ++compared;
      }
  EXPECT_GT(compared, eye.width_px * eye.height_px);
}

TEST_F(Warp, UncoveredPixelsAreBlackAndCounted) {
  const PanelEye eye = panel();
  const Picture picture = noise_picture(200, 190, eye.fov);
  const Pose old_eye = turned(0, 0), new_eye = turned(0.5, 0);
  DisplayRun run = quad(old_eye, new_eye);
  run.counters = true;
  const auto shown = run.show(eye, picture);
  const PanelReference reference(eye, picture, quad_warp(old_eye, new_eye, 100.0));
  std::int64_t certain = 0, possible = 0;
  for (int y = 0; y < eye.height_px; ++y)
    for (int x = 0; x < eye.width_px; ++x) {
      const ReferencePixel green = reference.at(1, x, y);
      certain += green.uncovered && !green.on_edge;
      possible += green.uncovered || green.on_edge;
      if (green.uncovered && !green.on_edge) {
        ASSERT_EQ(shown.image.at(x, y).g, 0) << x << ", " << y;
      }
    }
  EXPECT_GT(certain, 1000);
  EXPECT_GE(static_cast<std::int64_t>(shown.counts.uncovered), certain);
  EXPECT_LE(static_cast<std::int64_t>(shown.counts.uncovered), possible);

  run.world_from_new_eye = old_eye;
  EXPECT_EQ(run.show(eye, picture).counts.uncovered, 0u);
}

TEST_F(Warp, UncoveredCountsPanelPixelsAndNotThePadding) {
  const PanelEye eye{45, 19, sim::identity_lens({-1, 1, -1, 1}), {-9, 9, -9, 9}};  // sees beyond its panel
  const Picture aside = noise_picture(20, 20, {20, 21, 20, 21});
  DisplayRun run{device()};
  run.counters = true;
  EXPECT_EQ(run.show(eye, aside).counts.uncovered, 45u * 19u);
}

TEST_F(Warp, ExtremePosesNeverReadOutsideThePicture) {
  const PanelEye eye = panel();
  Picture white = noise_picture(200, 190, eye.fov);
  std::fill(white.pixels.begin(), white.pixels.end(), 0xffffffffu);
  const DisplayPipeline pipeline(device(), quad({}, {}).kernel(lens_traits(eye.lens)));
  PanelTarget target(device(), eye, white.shape);
  // The picture lies between guards of another value: a fetch before or behind it would show.
  const std::size_t guard = 4096, pixels = white.pixels.size();
  std::vector<std::uint32_t> guarded(pixels + 2 * guard, 0x00808080u);
  std::copy(white.pixels.begin(), white.pixels.end(), guarded.begin() + static_cast<std::ptrdiff_t>(guard));
  const gpu::Buffer source(device(), "source", guarded.size() * 4, gpu::Memory::device);
  gpu::upload_values<std::uint32_t>(device(), source, guarded);
  const gpu::TexelBuffer texels(device(), source, gpu::Format::r32_uint, guard * 4, pixels * 4);
  gpu::CommandList commands(device(), "display");
  pipeline.record(commands, target, texels);

  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  std::vector<std::pair<Pose, Pose>> poses{
      {turned(0, 0), turned(std::numbers::pi, 0)},      {turned(0, 0), turned(0, std::numbers::pi)},
      {turned(0, 0), turned(std::numbers::pi / 2, 0)},  {turned(0, 0, {0, 0, -100}), turned(0, 0)},
      {turned(0, 0, {0, 0, -100.0001}), turned(0, 0)},  {turned(0, 0, {0, 0, -1e9}), turned(0, 0)},
      {turned(0, 0, {1e30, 1e30, 1e30}), turned(0, 0)}, {turned(0, 0, {0, 0, 1e12}), turned(0.2, 0)}};
  for (int i = 0; i < 40; ++i)
    poses.push_back({turned(angle(random), angle(random), {angle(random) * 50, 0, angle(random) * 50}),
                     turned(angle(random), angle(random))});
  for (const auto& [old_eye, new_eye] : poses) {
    target.set_poses(device(), old_eye, new_eye);
    gpu::submit_and_wait(commands);
    const ImageRgba8 shown = target.read(device());
    for (const Rgba8& pixel : shown.pixels)
      for (const std::uint8_t value : {pixel.r, pixel.g, pixel.b})
        ASSERT_TRUE(value == 0 || value == 255);
  }
}

TEST_F(Warp, TurnedAwayNothingIsShown) {
  const PanelEye eye = panel();
  const Picture picture = noise_picture(200, 190, eye.fov);
  const ImageRgba8 shown = quad(turned(0, 0), turned(std::numbers::pi, 0)).show(eye, picture).image;
  for (const Rgba8& pixel : shown.pixels)
    ASSERT_EQ(pixel, (Rgba8{0, 0, 0, 255}));
}

}  // namespace
}  // namespace brace
