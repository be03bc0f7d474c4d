#include <cmath>

#include "gpu/display_reference.hpp"

namespace brace {
namespace {

class ScanOutWarp : public gpu::GpuTest {
 protected:
  PanelEye panel(sim::ScanDirection direction) const {
    PanelEye eye{96, 80, {}, {-1.2, 1.0, -1.1, 1.1}};
    eye.lens.kind = sim::LensKind::vive;
    eye.lens.panel_size_units = {2.0, 2.1};
    eye.lens.tan_per_unit = {0.75, 0.75};
    eye.lens.cutoff_radius = 1.2;
    for (sim::LensChannel& channel : eye.lens.rgb) {
      channel.k = {-0.2, -0.05, -0.02, 0.0, 0.0};
      channel.centre_uv = {0.52, 0.5};
    }
    eye.scan = sim::scan_fraction(direction, 80);
    return eye;
  }
  DisplayRun by_line(const char* warp, const ScanEye& eyes) const {
    DisplayRun run{device()};
    run.warp = warp;
    run.parameters["scan_out"] = 1.0;
    run.new_eye_by_line = eyes;
    run.world_from_old_eye = turned(0.35, 0.1);
    return run;
  }
};

Pose between(const Pose& first, const Pose& last, double at) {
  return {glm::slerp(first.orientation, last.orientation, at), glm::mix(first.position, last.position, at)};
}

// A turn of 11 degrees and 4 cm within the scan-out: 1000 degrees per second.
const ScanEye kQuickTurn{turned(0.30, 0.1, {0.0, 0.0, 0.0}), turned(0.49, 0.05, {0.04, 0.01, 0.0})};
const Pose kOldEye = turned(0.35, 0.1);

// Pixels of a channel that differ from the reference by more than `steps` of 255.
int differing(const ImageRgba8& image, const PanelEye& eye, const Picture& picture, double steps,
              const std::function<WarpReference(double)>& warp_at) {
  int count = 0, covered = 0;
  for (int y = 0; y < eye.height_px; ++y)
    for (int x = 0; x < eye.width_px; ++x) {
      const double at = eye.scan.at((x + 0.5) / eye.width_px, (y + 0.5) / eye.height_px);
      const ReferencePixel expected = PanelReference(eye, picture, warp_at(at)).at(1, x, y);
      if (expected.on_edge) continue;
      covered += expected.covered;
      count += std::abs(image.at(x, y).g - expected.value) > steps;
    }
  EXPECT_GT(covered, 2000);
  return count;
}

TEST_F(ScanOutWarp, EachLineIsSeenFromWhereTheEyeIsAtItsPhotons) {
  for (const auto direction : {sim::ScanDirection::top_to_bottom, sim::ScanDirection::right_to_left}) {
    const PanelEye eye = panel(direction);
    const Picture picture = directional_picture(160, 160, eye.fov, kOldEye);
    const ImageRgba8 shown = by_line("quad", kQuickTurn).show(eye, picture).image;
    const auto by_its_line = [&](double at) {
      return quad_warp(kOldEye,
                       between(kQuickTurn.world_from_first_line, kQuickTurn.world_from_last_line, at), 100.0);
    };
    const auto middle = [&](double) { return by_its_line(0.5); };
    // Between its ends the turn is taken as a chord, at 11 degrees a little off its arc.
    EXPECT_LE(differing(shown, eye, picture, 3.0, by_its_line), 15);
    EXPECT_GT(differing(shown, eye, picture, 3.0, middle), 500);
  }
}

TEST_F(ScanOutWarp, WithoutMotionWithinTheScanOutNothingChanges) {
  const PanelEye eye = panel(sim::ScanDirection::top_to_bottom);
  const Picture picture = noise_picture(150, 150, eye.fov);
  const std::vector<float> depths_m(picture.pixels.size(), 0.8f);
  for (const char* warp : {"quad", "grid"}) {
    const Pose now = turned(0.41, 0.07, {0.02, 0.0, -0.01});
    DisplayRun at_once{device()};
    at_once.warp = warp;
    at_once.world_from_old_eye = kOldEye;
    at_once.world_from_new_eye = now;
    DisplayRun lines = by_line(warp, {now, now});
    lines.world_from_old_eye = kOldEye;
    EXPECT_TRUE(lines.show(eye, picture, depths_m).image.pixels ==
                at_once.show(eye, picture, depths_m).image.pixels)
        << warp;
  }
}

TEST_F(ScanOutWarp, FractionsOfTheEyeFrameAreThoseOfThePanelThroughTheLens) {
  const PanelEye eye = panel(sim::ScanDirection::top_to_bottom);
  const SourcePicture source{60, 50, eye.fov};
  const std::vector<float> fractions = scan_fractions(eye, source);
  ASSERT_EQ(fractions.size(), 3000u);
  const double usable = sim::usable_radius(eye.lens, sim::Channel::green);
  int compared = 0;
  for (int line = 0; line < 80; ++line) {
    const glm::dvec2 uv(0.5, (line + 0.5) / 80);
    const auto tangents = sim::panel_to_tangents(eye.lens, sim::Channel::green, usable, uv);
    if (!tangents) continue;
    const glm::dvec2 at = sim::tangents_to_target_uv(source.fov, *tangents) * glm::dvec2(60, 50);
    if (at.y < 0 || at.y >= 50) continue;
    const float found = fractions[static_cast<std::size_t>(at.y) * 60 + static_cast<std::size_t>(at.x)];
    EXPECT_NEAR(found, line / 79.0, 0.025) << line;  // a pixel of the eye frame is 0.02 high
    ++compared;
  }
  EXPECT_GT(compared, 60);
}

}  // namespace
}  // namespace brace
