// warp/volumetric: the old view is the old picture, a homogeneous medium is exact from anywhere, extremes
// stay bounded.
#include "runtime/warp_layers/novel_view.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/core.h>
#include <gmock/gmock.h>

#include "runtime/replay/eye_renderer.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"

namespace brace {
namespace {

const std::filesystem::path data = BRACE_DATA_FOLDER;

PipelineStage stage_named(const std::string& family, const std::string& name) {
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

struct Settings {
  const char *layering = "thresholds", *sampling = "uniform", *filter = "linear", *behind = "empty";
  int layers = 4, steps = 32;
  const char* rays = "full_rate";
  double resolution_scale = 0.06;
};

Session session_of(const std::string& volume, const std::string& transfer, const Settings& settings) {
  Session session;
  session.device = {.profile = "htc-vive",
                    .resolution_scale = settings.resolution_scale,
                    .render_target = "panel",
                    .lens = "none",
                    .tracker = "ideal"};
  session.scene.volume = volume;
  session.scene.transfer_function = transfer;
  session.scene.shading = "none";
  session.scene.size_m = 0.5;
  session.scene.position = "front:0.8";
  session.scene.up = "+y";
  session.scene.front = "+z";
  session.scene.nan = "reject";
  session.scene.data_path = "auto";
  for (const auto& [family, name] : std::map<std::string, std::string>{{"rays", "full_rate"},
                                                                       {"cast", "dvr"},
                                                                       {"skip", "none"},
                                                                       {"stereo", "two_pass"},
                                                                       {"warp", "volumetric"}})
    session.pipeline[family] = stage_named(family, name);
  PipelineStage& warp = session.pipeline.at("warp");
  EXPECT_TRUE(warp.set_choice("layering", settings.layering) &&
              warp.set_choice("sampling", settings.sampling) && warp.set_choice("filter", settings.filter) &&
              warp.set_choice("behind", settings.behind) && warp.set("layers", settings.layers) &&
              warp.set("steps", settings.steps));
  return session;
}

/// An eye frame with layers, and pictures from other places.
class Rig {
 public:
  Rig(const gpu::Device& device, Session taken, const Pose& head = {})
      : session_(std::move(taken)),
        headset_(make_headset(session_.device, data)),
        placement_(place_volume(session_.scene, Pose{})),
        scene_(load_scene(device, session_, {.data_folder = data}, headset_, placement_)),
        renderer_(device, session_, headset_, *scene_, placement_, data, EyeRenderer::Counting::on, nullptr,
                  EyeRenderer::SecondEye::as_session, EyeRenderer::Layers::as_session),
        eyes_(make_eye_pair(device, session_, headset_)),
        view_(device, session_.pipeline.at("warp"), {data / "glsl", data / "kernels" / "warp_layers"},
              static_cast<bool>(eyes_[0].layer_rays)),
        into_(device, headset_.eye.width_px, headset_.eye.height_px),
        commands_(device, "test"),
        head_(head) {
    samples_ = renderer_.render(head_, eyes_).work.samples;
    const auto edges = box_size_with_longest_edge(scene_->volume.info(), placement_.size_m);
    box_ = {placement_.world_from_volume, edges};
  }

  ImageRgba8 source(const gpu::Device& device) const { return picture(device, eyes_[0].image); }

  ImageRgba8 from(const gpu::Device& device, const Pose& head) {
    commands_.reset();
    view_.record(commands_, layer_source(eyes_[0], view(head_)), view(head), into_, box_);
    gpu::submit_and_wait(commands_);
    return picture(device, into_.image);
  }

  NovelView::Counts counted() const { return view_.counted(); }
  const VolumePlacement& placement() const { return placement_; }
  EyeView view(const Pose& head) const { return eye_view(headset_, sim::Eye::left, head); }
  std::uint64_t samples() const { return samples_; }

 private:
  ImageRgba8 picture(const gpu::Device& device, const gpu::Buffer& buffer) const {
    ImageRgba8 image(headset_.eye.width_px, headset_.eye.height_px);
    gpu::download_values<Rgba8>(device, buffer, image.pixels);
    return image;
  }

  Session session_;
  Headset headset_;
  VolumePlacement placement_;
  std::unique_ptr<SceneOnDevice> scene_;
  EyeRenderer renderer_;
  EyePair eyes_;
  NovelView view_;
  EyeTarget into_;
  NovelView::Box box_;
  gpu::CommandList commands_;
  Pose head_;
  std::uint64_t samples_ = 0;
};

int largest_difference(const ImageRgba8& a, const ImageRgba8& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const Rgba8 &p = a.pixels[i], &q = b.pixels[i];
    for (const int off : {p.r - q.r, p.g - q.g, p.b - q.b, p.a - q.a})
      most = std::max(most, std::abs(off));
  }
  return most;
}

/// No colour above its opacity, but for rounding.
int largest_excess(const ImageRgba8& image) {
  int most = -255;
  for (const Rgba8& p : image.pixels)
    most = std::max({most, p.r - p.a, p.g - p.a, p.b - p.a});
  return most;
}

int largest_alpha(const ImageRgba8& image) {
  int most = 0;
  for (const Rgba8& p : image.pixels)
    most = std::max<int>(most, p.a);
  return most;
}

Pose moved(double x, double y, double z, double turn = 0.0) {
  Pose pose;
  pose.position = {x, y, z};
  pose.orientation = quat_exp({0.0, turn, 0.0});
  return pose;
}

class NovelViewTest : public gpu::GpuTest {
 protected:
  /// A transfer function that has one absorption per metre and colour everywhere.
  static std::string fog(double kappa_per_m) {
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) / ("fog-" + std::to_string(kappa_per_m) + ".toml");
    const auto point = [&](double value) {
      return fmt::format("{{ value = {}, r = 1.0, g = 0.5, b = 0.25, absorption = {} }},", value,
                         kappa_per_m);
    };
    std::ofstream(file) << "domain = 'fraction'\nabsorption_unit = 'per_metre'\npoints = [" << point(0.0)
                        << point(1.0) << "]\n";
    return file.string();
  }
};

TEST_F(NovelViewTest, FromTheOldPlaceThePictureIsTheOldOne) {
  for (const auto& [volume, transfer] :
       std::map<std::string, std::string>{{"generator:nested_shells:48", "tf3"},
                                          {"generator:fractal_vessels:48", "ct-soft-tissue"},
                                          {"generator:marschner_lobb:32", "mri-brain"}}) {
    for (const Settings& settings :
         {Settings{}, Settings{.filter = "nearest"}, Settings{.sampling = "exact"},
          Settings{.sampling = "exact", .filter = "nearest"}, Settings{.layers = 1}, Settings{.layers = 8},
          Settings{.layering = "equal"}, Settings{.steps = 3}, Settings{.behind = "extend"}}) {
      Rig rig(device(), session_of(volume, transfer, settings));
      const ImageRgba8 source = rig.source(device());
      EXPECT_GT(largest_alpha(source), 100) << volume;
      // One layer mixes the colours of all a ray has met, but their sum is the ray's. What goes on behind a
      // stopped ray adds to the hundredth that was left of it.
      EXPECT_LE(largest_difference(rig.from(device(), Pose{}), source),
                settings.behind == std::string("extend") ? 3 : 1)
          << volume << " " << settings.layering << " " << settings.sampling << " " << settings.filter << " "
          << settings.layers << " " << settings.steps << " " << settings.behind;
    }
  }
}

TEST_F(NovelViewTest, AHomogeneousBoxIsExactFromAnywhere) {
  constexpr double kappa_per_m = 3.0;
  for (const char* sampling : {"uniform", "exact"}) {
    Rig rig(device(), session_of("generator:slab:24", fog(kappa_per_m),
                                 {.sampling = sampling, .layers = 1, .resolution_scale = 0.3}));
    for (const Pose& head :
         {Pose{}, moved(0.1, 0.02, 0.0), moved(-0.05, 0.0, 0.1, 0.1), moved(0.0, 0.1, -0.15)}) {
      const ImageRgba8 image = rig.from(device(), head);
      const EyeView view = rig.view(head);
      double sum = 0.0;
      int inner = 0, worst = 0;
      for (int y = 0; y < image.height_px; ++y) {
        for (int x = 0; x < image.width_px; ++x) {
          const glm::dvec3 tangents(
              view.tan_left + (x + 0.5) * (view.tan_right - view.tan_left) / view.width_px,
              view.tan_top + (y + 0.5) * (view.tan_bottom - view.tan_top) / view.height_px, -1.0);
          const Pose box_from_eye = compose(inverse(rig.placement().world_from_volume), view.world_from_eye);
          const glm::dvec3 from = box_from_eye.position;
          const glm::dvec3 along = glm::normalize(box_from_eye.orientation * tangents);
          double begin = 0.0, end = 1e9;
          for (int axis = 0; axis < 3; ++axis) {
            const double a = (-0.25 - from[axis]) / along[axis], b = (0.25 - from[axis]) / along[axis];
            begin = std::max(begin, std::min(a, b));
            end = std::min(end, std::max(a, b));
          }
          if (end - begin < 0.3)
            continue;  // not next to the silhouette: what old pixels saw there is a pixel coarse
          const double opacity = -std::expm1(-kappa_per_m * (end - begin));
          const int off = std::abs(image.at(x, y).a - static_cast<int>(std::lround(255.0 * opacity)));
          worst = std::max(worst, off);
          sum += off;
          ++inner;
        }
      }
      ASSERT_GT(inner, 100);
      EXPECT_LE(sum / inner, 1.0) << sampling;
      EXPECT_LE(worst, 4) << sampling;
    }
  }
}

TEST_F(NovelViewTest, ExtremesStayBounded) {
  const std::vector<Pose> heads = {Pose{},
                                   moved(0, 0, 0, M_PI),     // the other way round
                                   moved(0, 0, -0.8),        // in the middle of the volume
                                   moved(0, 0, -2.0),        // behind it
                                   moved(0, 0, -2.0, M_PI),  // behind it, looking back
                                   moved(1e5, 0, 0),
                                   moved(0, 1e-9, 0),
                                   moved(0.3, -0.3, 0.3, 1.5)};
  for (const double kappa_per_m : {0.0, 1e-9, 1e12}) {
    for (const Settings& settings :
         {Settings{}, Settings{.sampling = "exact"}, Settings{.behind = "extend", .layers = 8}}) {
      Rig rig(device(), session_of("generator:slab:8", fog(kappa_per_m), settings));
      for (const Pose& head : heads) {
        const ImageRgba8 image = rig.from(device(), head);
        EXPECT_LE(largest_excess(image), 1) << kappa_per_m;
        if (kappa_per_m < 1.0) {
          EXPECT_EQ(largest_alpha(image), 0);
        }
      }
      EXPECT_EQ(largest_alpha(rig.from(device(), Pose{})), kappa_per_m < 1.0 ? 0 : 255) << kappa_per_m;
    }
  }
  // Cast from inside the volume.
  Rig inside(device(), session_of("generator:nested_shells:32", "mri-brain", {}), moved(0, 0, -0.8));
  for (const Pose& head : heads)
    EXPECT_LE(largest_excess(inside.from(device(), head)), 1);
}

TEST_F(NovelViewTest, WhatIsNotKnownIsCounted) {
  Rig still(device(), session_of("generator:slab:24", fog(1e3), {}));
  (void)still.from(device(), Pose{});
  EXPECT_EQ(still.counted().uncovered, 0u);
  EXPECT_GT(still.counted().segments, 0u);
  (void)still.from(device(), moved(0.0, 0.0, -0.3, 0.8));
  Rig close(device(), session_of("generator:slab:24", fog(1.0), {}), moved(0, 0, -0.45));
  (void)close.from(device(), moved(0.2, 0, -0.45, 0.7));
  EXPECT_GT(close.counted().uncovered, 0u) << "the box is larger than the picture";
  Rig behind(device(), session_of("generator:slab:24", fog(1e3), {.behind = "extend"}));
  (void)behind.from(device(), moved(0.2, 0, 0));
  EXPECT_GT(behind.counted().filled, 0u);
}

TEST_F(NovelViewTest, LayersOfTheAtlasGiveThePictureOfTheAtlas) {
  for (const char* filter : {"nearest", "linear"}) {
    Rig rig(device(), session_of("generator:nested_shells:48", "mri-brain",
                                 {.filter = filter, .rays = "mab", .resolution_scale = 0.15}));
    const ImageRgba8 source = rig.source(device()), view = rig.from(device(), Pose{});
    EXPECT_GT(largest_alpha(source), 200);
    EXPECT_LE(largest_excess(view), 1);
    // Levels are interpolated in the one and blocks in the other: alike, not equal.
    double sum = 0.0;
    for (std::size_t i = 0; i < source.pixels.size(); ++i)
      sum += std::abs(source.pixels[i].a - view.pixels[i].a);
    EXPECT_LT(sum / static_cast<double>(source.pixels.size()), 3.0) << filter;
  }
}

TEST_F(NovelViewTest, LayersOfEqualSharesTakeASecondCast) {
  const Session once = session_of("generator:nested_shells:32", "tf3", {});
  const Session twice = session_of("generator:nested_shells:32", "tf3", {.layering = "equal"});
  EXPECT_EQ(Rig(device(), twice).samples(), 2 * Rig(device(), once).samples());
}

TEST_F(NovelViewTest, TooManyBytesAreRefusedWithWhatWouldFit) {
  try {
    (void)EyeTarget(device(), 8192, 8192, {.count = 8});
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), testing::HasSubstr("at most"));
  }
}

}  // namespace
}  // namespace brace
