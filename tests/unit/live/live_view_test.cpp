// Views of the eyes against what they are views of.
#include "tools/live/live_view.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"

namespace brace {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path data = BRACE_DATA_FOLDER;
constexpr double box_m = 0.4, away_m = 0.8;

PipelineStage stage_of(const std::string& family, const std::string& name) {
  static const StageRegistry registry = [] {
    StageRegistry made;
    made.add_folder(data / "stages");
    return made;
  }();
  PipelineStage chosen{registry.find(family, name, "test"), {}};
  for (const StageParameter& parameter : chosen.stage.parameters)
    chosen.values.push_back(parameter.default_value);
  return chosen;
}

Session session_with(const char* rays, const char* skip) {
  Session session;
  session.device = {.profile = "htc-vive",
                    .resolution_scale = 0.06,
                    .render_target = "panel",
                    .lens = "none",
                    .tracker = "ideal"};
  session.scene.volume = "generator:solid_box:24";
  session.scene.transfer_function = "tf1";
  session.scene.shading = session.plan.shading = "none";
  session.scene.size_m = box_m;
  session.scene.position = "front:0.8";
  session.scene.up = "+y";
  session.scene.front = "+z";
  session.scene.nan = "reject";
  session.scene.data_path = "auto";
  for (const auto& [family, name] : std::map<std::string, std::string>{
           {"rays", rays}, {"cast", "dvr"}, {"skip", skip}, {"stereo", "two_pass"}, {"warp", "none"}})
    session.pipeline[family] = stage_of(family, name);
  return session;
}

/// A session's eyes from the origin, and what a view makes of them.
class Rig {
 public:
  Rig(const gpu::Device& device, Session taken)
      : device_(device),
        session_(std::move(taken)),
        headset_(make_headset(session_.device, data)),
        placement_(place_volume(session_.scene, Pose{})),
        options_{.data_folder = data,
                 .no_warp = stage_of("warp", "none"),
                 .full_rate = stage_of("rays", "full_rate")},
        scene_(load_scene(device, session_, options_, headset_, placement_)),
        renderer_(device, session_, headset_, *scene_, placement_, data, EyeRenderer::Counting::on),
        display_(device, headset_, options_.no_warp, data),
        eyes_(make_eye_pair(device, session_, headset_)) {}

  PanelPair see(ViewKind kind) {
    view_.emplace(LiveView::Inputs{device_, options_, session_, headset_, *scene_, placement_}, kind);
    EyeRenderer& renderer = view_->renderer() != nullptr ? *view_->renderer() : renderer_;
    work_ = renderer.render(Pose{}, eyes_).work;
    display_.show({eyes_});
    return view_->make(display_.read(), eyes_, Pose{}, Pose{});
  }
  std::string refusal(ViewKind kind) {
    try {
      see(kind);
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
      return error.what();
    }
    return "";
  }
  ImageRgba8 eye_picture(std::size_t eye) const {
    ImageRgba8 image(headset_.eye.width_px, headset_.eye.height_px);
    gpu::download_values<Rgba8>(device_, eyes_[eye].image, image.pixels);
    return image;
  }
  const WorkCounts& work() const { return work_; }
  const ViewLegend& legend() const { return view_->legend(); }
  const Headset& headset() const { return headset_; }

 private:
  const gpu::Device& device_;
  Session session_;
  Headset headset_;
  VolumePlacement placement_;
  ReplayOptions options_;
  std::unique_ptr<SceneOnDevice> scene_;
  EyeRenderer renderer_;
  PanelDisplay display_;
  EyePair eyes_;
  std::optional<LiveView> view_;
  WorkCounts work_;
};

class LiveViews : public gpu::GpuTest {};

/// The counts that the greys of both eyes stand for: to half a grey each.
double decoded_sum(const Rig& rig) {
  double sum = 0.0;
  for (std::size_t eye = 0; eye < 2; ++eye)
    for (const Rgba8& pixel : rig.eye_picture(eye).pixels)
      if (pixel.g > 0) sum += std::exp2(10.0 * (pixel.g - 1) / 254.0) - 1.0;
  return sum;
}

TEST_F(LiveViews, HeatsSumUpToTheWorkThatIsCounted) {
  Rig rig(device(), session_with("full_rate", "distance_map"));
  rig.see(ViewKind::samples);
  ASSERT_GT(rig.work().samples, 1000U);
  const auto samples = static_cast<double>(rig.work().samples);
  EXPECT_NEAR(decoded_sum(rig), samples, 0.02 * samples);
  rig.see(ViewKind::skip_steps);
  ASSERT_GT(rig.work().skip_steps, 100U);
  const auto steps = static_cast<double>(rig.work().skip_steps);
  EXPECT_NEAR(decoded_sum(rig), steps, 0.03 * steps);
}

/// The colour at the pixel that looks straight ahead, without a lens.
Rgba8 ahead(const Rig& rig, const PanelPair& panels) {
  const sim::FovTangents fov = rig.headset().profile.eyes[0].fov;
  const ImageRgba8& panel = panels[0];
  return panel.at(static_cast<int>(panel.width_px * -fov.left / fov.width()),
                  static_cast<int>(panel.height_px * fov.top / fov.height()));
}

double scale_place(Rgba8 colour) {
  double best = 0.0, least = 1e9;
  for (int i = 0; i <= 254; ++i) {
    const Rgba8 there = scale_colour(i / 254.0);
    const double off =
        std::abs(there.r - colour.r) + std::abs(there.g - colour.g) + std::abs(there.b - colour.b);
    if (off < least) least = off, best = i / 254.0;
  }
  EXPECT_LT(least, 6.0);
  return best;
}

TEST_F(LiveViews, DepthIsThatOfTheBoxsFace) {
  Rig rig(device(), session_with("full_rate", "none"));
  const PanelPair seen = rig.see(ViewKind::depth);
  EXPECT_EQ(seen[0].at(0, 0), (Rgba8{0, 0, 0, 255})) << "nothing is hit";
  // solid_box fills the middle half of the volume.
  const double radius_m = 0.5 * box_m * std::sqrt(3.0), face_m = away_m - 0.25 * box_m;
  const double nearness = (away_m + radius_m - face_m) / (2.0 * radius_m);
  EXPECT_NEAR(scale_place(ahead(rig, seen)), nearness, 0.05);
  EXPECT_EQ(rig.legend().low, fmt::format("{:.2f} m", away_m + radius_m));
}

TEST_F(LiveViews, LevelsAreFineAtTheGazeAndCoarseFarFromIt) {
  Rig rig(device(), session_with("mab", "none"));
  const PanelPair seen = rig.see(ViewKind::levels);
  ASSERT_GE(rig.legend().swatches.size(), 2U);
  const auto is_level = [&](Rgba8 pixel, std::size_t level) {  // over black
    const Rgba8 colour = rig.legend().swatches.at(level).first;
    return std::abs(pixel.r - 0.45 * colour.r) < 2 && std::abs(pixel.g - 0.45 * colour.g) < 2;
  };
  EXPECT_TRUE(is_level(seen[0].at(2, 2), rig.legend().swatches.size() - 1));
  EXPECT_FALSE(is_level(seen[0].at(seen[0].width_px / 2, 2), 0));
}

TEST_F(LiveViews, AnIdealSessionDiffersNowhereAndOneWithFewerRaysDoes) {
  Rig ideal(device(), session_with("full_rate", "none"));
  for (const ViewKind kind : {ViewKind::difference, ViewKind::dssim})
    for (const ImageRgba8& panel : ideal.see(kind))
      for (const Rgba8& pixel : panel.pixels)
        ASSERT_EQ(pixel, (Rgba8{0, 0, 0, 255})) << name_of(kind);
  EXPECT_THAT(ideal.legend().words, HasSubstr("DSSIM 0 left, 0 right"));

  Rig fewer(device(), session_with("mab", "none"));
  for (const ViewKind kind : {ViewKind::difference, ViewKind::dssim}) {
    int differing = 0;
    for (const ImageRgba8& panel : fewer.see(kind))
      for (const Rgba8& pixel : panel.pixels)
        differing += !(pixel == Rgba8{0, 0, 0, 255});
    EXPECT_GT(differing, 20) << name_of(kind);
  }
}

TEST_F(LiveViews, WhatASessionHasNothingOfIsRefused) {
  Rig rig(device(), session_with("full_rate", "none"));
  EXPECT_THAT(rig.refusal(ViewKind::levels), HasSubstr("accepted: pipeline.rays = mab"));
  EXPECT_THAT(rig.refusal(ViewKind::skip_steps), HasSubstr("pipeline.skip other than none"));
  EXPECT_EQ(rig.refusal(ViewKind::samples), "");
}

}  // namespace
}  // namespace brace
