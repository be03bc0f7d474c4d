// warp/grid against surfaces whose picture from the new pose is known.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "gpu/display_reference.hpp"

namespace brace {
namespace {

constexpr float none = std::numeric_limits<float>::infinity();

PanelEye flat_panel() {
  const sim::FovTangents fov{-1.0, 1.0, -1.0, 1.0};
  return {160, 160, sim::identity_lens(fov), fov};
}

glm::dvec2 tangents_at(const Picture& picture, int x, int y) {
  return sim::target_uv_to_tangents(
      picture.shape.fov, {(x + 0.5) / picture.shape.width_px, (y + 0.5) / picture.shape.height_px});
}

/// Colour of a place in the world.
double colour_at(const glm::dvec3& place_m, std::size_t channel) {
  return 127.5 + 110.0 * std::sin(4.0 * place_m.x + static_cast<double>(channel)) *
                     std::cos(3.0 * place_m.y - place_m.z);
}

std::uint32_t pack(const glm::dvec3& place_m) {
  std::uint32_t pixel = 0xff000000u;
  for (std::size_t channel = 0; channel < 3; ++channel)
    pixel |= static_cast<std::uint32_t>(std::lround(colour_at(place_m, channel))) << (8 * channel);
  return pixel;
}

/// A plane, n * x = d, in the world.
struct Plane {
  glm::dvec3 normal;
  double distance_m;
  glm::dvec3 hit(const Pose& world_from_eye, glm::dvec2 tan_xy) const {
    const glm::dvec3 direction = world_from_eye.orientation * glm::dvec3(tan_xy, -1.0);
    const double s = (distance_m - glm::dot(normal, world_from_eye.position)) / glm::dot(normal, direction);
    return world_from_eye.position + s * direction;
  }
};

struct Seen {
  Picture picture;
  std::vector<float> depths_m;
};

Seen see(const Plane& plane, const Pose& eye) {
  Seen seen{{{400, 400, {-1.2, 1.2, -1.2, 1.2}}, {}}, {}};
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 400; ++x) {
      const glm::dvec3 place = plane.hit(eye, tangents_at(seen.picture, x, y));
      seen.picture.pixels.push_back(pack(place));
      seen.depths_m.push_back(static_cast<float>(glm::length(place - eye.position)));
    }
  return seen;
}

class GridWarp : public gpu::GpuTest {
 protected:
  DisplayRun grid(const Pose& old_eye, const Pose& new_eye) const {
    DisplayRun run{device()};
    run.warp = "grid";
    run.counters = true;
    run.world_from_old_eye = old_eye;
    run.world_from_new_eye = new_eye;
    return run;
  }
};

TEST_F(GridWarp, ShowsAPlaneAsTheNewPoseSeesIt) {
  const PanelEye eye = flat_panel();
  const Plane planes[] = {
      {{0, 0, 1}, -1.0}, {{0, 0, 1}, -0.4}, {glm::normalize(glm::dvec3(0.4, 0.1, 1)), -0.8}};
  const std::pair<Pose, Pose> poses[] = {
      {turned(0, 0), turned(0, 0, {0.03, 0, 0})},
      {turned(0, 0), turned(0.03, -0.02, {-0.01, 0.02, 0.02})},
      {turned(0.1, 0.05, {0.1, 0, 0}), turned(0.12, 0.03, {0.11, 0.01, -0.03})}};
  for (const Plane& plane : planes)
    for (const auto& [old_eye, new_eye] : poses)
      for (const auto& [edges, search] : {std::pair(0.0, 0.0), {1.0, 0.0}, {0.0, 1.0}}) {
        const Seen seen = see(plane, old_eye);
        DisplayRun run = grid(old_eye, new_eye);
        run.parameters["edges"] = edges;
        run.parameters["search"] = search;  // a plane's parallax hardly changes over four pixels
        const auto shown = run.show(eye, seen.picture, seen.depths_m);
        double worst = 0.0, quad_worst = 0.0;
        for (int y = 20; y < 140; ++y)
          for (int x = 20; x < 140; ++x) {
            const glm::dvec2 t = sim::target_uv_to_tangents(eye.fov, {(x + 0.5) / 160, (y + 0.5) / 160});
            const glm::dvec3 place = plane.hit(new_eye, t);
            worst = std::max(worst, std::abs(shown.image.at(x, y).g - colour_at(place, 1)));
            const glm::dvec3 without = plane.hit({new_eye.orientation, old_eye.position}, t);
            quad_worst = std::max(quad_worst, std::abs(colour_at(without, 1) - colour_at(place, 1)));
          }
        // Half a pixel's depth, at a slope of the colours of up to 2 steps per pixel, and two roundings.
        EXPECT_LT(worst, 3.5);
        EXPECT_GT(quad_worst, 2.0 * worst) << "rotation alone would not do";
        EXPECT_EQ(shown.counts.filled, 0U) << "no edge anywhere";
      }
}

TEST_F(GridWarp, WithoutMotionIsThePictureWhateverTheDepths) {
  const PanelEye eye = flat_panel();
  const Picture picture = noise_picture(180, 170, eye.fov);
  std::mt19937 random(5);
  std::vector<float> depths_m;
  for (std::size_t i = 0; i < picture.pixels.size(); ++i)
    depths_m.push_back(random() % 3 == 0 ? none : 0.1f + static_cast<float>(random() % 1000) * 0.01f);
  const Pose pose = turned(1.0, -0.4, {3, 1, 2});
  for (const double search : {0.0, 1.0}) {
    DisplayRun run = grid(pose, pose);
    run.parameters["search"] = search;
    expect_like_reference(run.show(eye, picture, depths_m).image, eye, picture, no_warp(), "equal poses");
  }
}

TEST_F(GridWarp, UnderRotationAloneIsTheQuad) {
  const PanelEye eye = flat_panel();
  const Picture picture = noise_picture(180, 170, eye.fov);
  const std::vector<float> depths_m(picture.pixels.size(), 0.7f);
  const Pose old_eye = turned(0.2, 0.1), new_eye = turned(0.25, 0.06);
  for (const double search : {0.0, 1.0}) {
    DisplayRun run = grid(old_eye, new_eye);
    run.parameters["search"] = search;
    expect_like_reference(run.show(eye, picture, depths_m).image, eye, picture,
                          quad_warp(old_eye, new_eye, 1e6), "rotation");
  }
}

/// A near square before a far wall; the eye moves right, and wall comes out at the square's left edge... on
/// the side that the old eye could not see.
TEST_F(GridWarp, WhatComesOutBehindAnEdgeIsShownAsBackgroundAndCounted) {
  const PanelEye eye = flat_panel();
  Picture picture{{400, 400, {-1.2, 1.2, -1.2, 1.2}}, {}};
  std::vector<float> depths_m;
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 400; ++x) {
      const glm::dvec2 t = tangents_at(picture, x, y);
      const bool square = std::max(std::abs(t.x), std::abs(t.y)) < 0.3;
      picture.pixels.push_back(square ? 0xff0000ffu : 0xff00ff00u);  // red before green
      depths_m.push_back(static_cast<float>((square ? 0.5 : 4.0) * std::sqrt(1.0 + glm::dot(t, t))));
    }
  const double shift_m = 0.04;  // 0.08 of the square's tangents, 0.01 of the wall's
  const Pose new_eye = turned(0, 0, {shift_m, 0, 0});
  for (const bool cut : {true, false}) {
    DisplayRun run = grid({}, new_eye);
    run.parameters["edges"] = cut ? 0.0 : 1.0;
    const auto shown = run.show(eye, picture, depths_m);
    const int row = 80;
    const auto red_at = [&](double tan_x) {
      return int{shown.image.at(static_cast<int>((tan_x + 1.0) * 80), row).r};
    };
    EXPECT_EQ(red_at(-0.36), 255) << "the square has moved to the left";
    EXPECT_EQ(red_at(-0.40), 0);
    EXPECT_EQ(red_at(0.20), 255);
    EXPECT_EQ(red_at(0.31), 0);
    // Between the square's new right edge at 0.22 and the wall's share of the motion the old eye saw no wall.
    const int in_the_gap = red_at(0.25);
    if (cut) {
      EXPECT_EQ(in_the_gap, 0) << "wall goes on";
      // 0.07 of tangents wide, 0.6 high, at 80 pixels per tangent.
      EXPECT_NEAR(static_cast<double>(shown.counts.filled), 0.07 * 80 * 0.6 * 80, 0.4 * 0.07 * 80 * 0.6 * 80);
    } else {
      EXPECT_GT(in_the_gap, 0) << "stretched across";
      EXPECT_LT(in_the_gap, 255);
      EXPECT_EQ(shown.counts.filled, 0U);
    }
  }
}

TEST_F(GridWarp, AnEmptyPictureStaysItAndExtremesNeverReadOutside) {
  const PanelEye eye = flat_panel();
  Picture white = noise_picture(100, 90, eye.fov);
  std::fill(white.pixels.begin(), white.pixels.end(), 0xffffffffu);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  const float odd[] = {none, -none, 0.0f, -1.0f, 1e-30f, 1e30f, std::numeric_limits<float>::quiet_NaN(),
                       0.3f, 2.0f};
  std::vector<float> depths_m;
  for (std::size_t i = 0; i < white.pixels.size(); ++i)
    depths_m.push_back(odd[random() % std::size(odd)]);
  std::vector<std::pair<Pose, Pose>> poses{
      {turned(0, 0), turned(std::numbers::pi, 0)}, {turned(0, 0), turned(std::numbers::pi / 2, 0)},
      {turned(0, 0, {0, 0, -100}), turned(0, 0)},  {turned(0, 0, {0, 0, 0.15}), turned(0, 0)},
      {turned(0, 0, {0, 0, -1e9}), turned(0, 0)},  {turned(0, 0, {1e30, 1e30, 1e30}), turned(0, 0)},
      {turned(0, 0, {0, 0, 1e12}), turned(0.2, 0)}};
  for (int i = 0; i < 12; ++i)
    poses.push_back({turned(angle(random), angle(random), {angle(random), 0, angle(random)}),
                     turned(angle(random), angle(random))});
  for (const auto& [old_eye, new_eye] : poses)
    for (const auto& [edges, search] : {std::pair(0.0, 0.0), {1.0, 1.0}}) {
      DisplayRun run = grid(old_eye, new_eye);
      run.parameters["edges"] = edges;
      run.parameters["search"] = search;
      for (const Rgba8& pixel : run.show(eye, white, depths_m).image.pixels)
        for (const std::uint8_t value : {pixel.r, pixel.g, pixel.b})
          ASSERT_TRUE(value == 0 || value == 255);
    }
  // Nothing hit anywhere: as rotation alone.
  const std::vector<float> nothing(white.pixels.size(), none);
  const Picture picture = noise_picture(100, 90, eye.fov);
  expect_like_reference(grid(turned(0, 0), turned(0.05, 0, {0.1, 0, 0})).show(eye, picture, nothing).image,
                        eye, picture, quad_warp(turned(0, 0), turned(0.05, 0), 1e6), "nothing hit");
}

}  // namespace
}  // namespace brace
