// Single-pass stereo where it is hard, and against the scan-line oracle.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>

#include <gmock/gmock.h>

#include "runtime/metrics/image_error.hpp"
#include "runtime/replay/eye_renderer.hpp"
#include "runtime/stereo/scan_line.hpp"
#include "tests/reference/raycaster.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"
#include "tests/unit/stereo_matrix/stereo_session.hpp"

namespace brace {
namespace {

using namespace test;
using ::testing::HasSubstr;

using EyePictures = std::array<ImageRgba8, 2>;

Session still_session(const std::string& stereo, double across_px) {
  Session session = stereo_session({{"rays", "full_rate"},
                                    {"skip", "none"},
                                    {"stereo", stereo},
                                    {"schedule", "whole_frame"},
                                    {"warp", "none"}});
  session.device.resolution_scale = across_px / 1080.0;
  return session;
}

/// Changes what there is of a headset.
using Fitting = void (*)(Headset&);

/// Both eyes see the same angles; the left one's.
void alike(Headset& headset) {
  headset.profile.eyes[1].fov = headset.profile.eyes[0].fov;
}

void in_one_place(Headset& headset) {
  alike(headset);
  headset.profile.eyes[1].head_from_eye = headset.profile.eyes[0].head_from_eye;
}

struct Rig {
  Rig(const gpu::Device& device, Session taken, Fitting fitting = nullptr)
      : session(std::move(taken)),
        headset([&] {
          Headset made = make_headset(session.device, data);
          if (fitting != nullptr) fitting(made);
          return made;
        }()),
        placement(place_volume(session.scene, Pose{})),
        eyes(make_eye_pair(device, session, headset)),
        scene(load_scene(device, session, {.data_folder = data}, headset, placement)),
        renderer(device, session, headset, *scene, placement, data, EyeRenderer::Counting::on) {}

  EyePictures render(const gpu::Device& device, const Pose& head = {}) {
    renderer.render(head, eyes);
    EyePictures pictures = {ImageRgba8(headset.eye.width_px, headset.eye.height_px),
                            ImageRgba8(headset.eye.width_px, headset.eye.height_px)};
    for (std::size_t eye = 0; eye < 2; ++eye)
      gpu::download_values<Rgba8>(device, eyes[eye].image, pictures[eye].pixels);
    return pictures;
  }

  Session session;
  Headset headset;
  VolumePlacement placement;
  EyePair eyes;
  std::unique_ptr<SceneOnDevice> scene;
  EyeRenderer renderer;
};

double dssim(const ImageRgba8& a, const ImageRgba8& b) {
  return dssim_from_ssim(ssim(a, b));
}

int most_opaque(const ImageRgba8& image) {
  int most = 0;
  for (const Rgba8& pixel : image.pixels)
    most = std::max<int>(most, pixel.a);
  return most;
}

class StereoExtremes : public gpu::GpuTest {
 protected:
  EyePictures render(Session session, const Pose& head = {}, Fitting fitting = nullptr) {
    Rig rig(device(), std::move(session), fitting);
    return rig.render(device(), head);
  }

  /// The right eye is like that of two passes, the left the same; something is seen.
  void expect_like_two_passes(const std::function<void(Session&)>& set, double dssim_max,
                              const Pose& head = {}) {
    Session twice = still_session("two_pass", 96);
    set(twice);
    const EyePictures two = render(std::move(twice), head);
    EXPECT_GT(most_opaque(two[1]), 40);
    for (const char* stereo : {"layers", "novel_view"}) {
      Session once = still_session(stereo, 96);
      set(once);
      const EyePictures one = render(std::move(once), head);
      EXPECT_EQ(one[0].pixels, two[0].pixels) << stereo;
      EXPECT_LE(dssim(one[1], two[1]), dssim_max) << stereo;
    }
  }
};

TEST_F(StereoExtremes, EyesInOnePlaceSeeTheSameBitForBit) {
  for (const char* reference : {"left", "middle"}) {
    for (const double layers : {0.0, 8.0}) {
      Session session = still_session("layers", 96);
      ASSERT_TRUE(session.pipeline.at("stereo").set("layers", layers) &&
                  session.pipeline.at("stereo").set_choice("reference", reference));
      const EyePictures pictures = render(std::move(session), {}, in_one_place);
      EXPECT_GT(most_opaque(pictures[0]), 40);
      EXPECT_EQ(pictures[0].pixels, pictures[1].pixels) << reference << " " << layers;
    }
  }
}

TEST_F(StereoExtremes, HeadRolledByAQuarterTurn) {
  Pose rolled;
  rolled.orientation = quat_exp({0.0, 0.0, 0.5 * std::numbers::pi});
  expect_like_two_passes([](Session&) {}, 0.01, rolled);
}

TEST_F(StereoExtremes, CantedDisplaysAreRectifiedAndBothEyesAreLikeThoseOfTwoPasses) {
  Pose rolled;
  rolled.orientation = quat_exp({0.0, 0.0, 0.5 * std::numbers::pi});
  for (const Pose& head : {Pose{}, rolled}) {
    const auto canted = [](const char* stereo) {
      Session session = still_session(stereo, 96);
      session.device.profile = "valve-index";
      return session;
    };
    const EyePictures two = render(canted("two_pass"), head), one = render(canted("layers"), head);
    EXPECT_GT(most_opaque(two[1]), 40);
    EXPECT_GT(dssim(two[0], two[1]), 0.03) << "the eyes see alike: nothing is proved";
    EXPECT_LE(dssim(one[0], two[0]), 0.0006);  // cast on its plane and resampled
    EXPECT_LE(dssim(one[1], two[1]), 0.002);
  }
}

TEST_F(StereoExtremes, OneVoxel) {
  expect_like_two_passes([](Session& session) { session.scene.volume = "generator:slab:1"; }, 0.01);
}

TEST_F(StereoExtremes, BehindTheEyes) {
  for (const char* stereo : {"layers", "novel_view"}) {
    Session session = still_session(stereo, 48);
    session.scene.position = "front:-2";
    for (const ImageRgba8& picture : render(std::move(session)))
      EXPECT_EQ(most_opaque(picture), 0) << stereo;
  }
}

TEST_F(StereoExtremes, AroundTheEyesIsCastTwice) {
  const auto inside = [](const char* stereo) {
    Session session = still_session(stereo, 48);
    session.scene.position = "front:0.1";
    return session;
  };
  const EyePictures two = render(inside("two_pass"));
  Rig rig(device(), inside("layers"));
  const EyePictures one = rig.render(device());
  EXPECT_EQ(one[1].pixels, two[1].pixels);
  EXPECT_THAT(rig.renderer.stereo_note(), HasSubstr("1 of 1 eye frames were ray cast twice"));
}

TEST_F(StereoExtremes, AtTheNearPlaneLayersAreEnoughAndOneFewerIsNoticed) {
  // The nearest face of the box is a quarter of a metre before the eyes.
  const auto at_near_plane = [](const char* stereo, int layers) {
    Session session = still_session(stereo, 96);
    session.scene.position = "front:0.55";
    if (layers >= 0) {
      EXPECT_TRUE(session.pipeline.at("stereo").set("layers", layers));
    }
    return session;
  };
  const EyePictures two = render(at_near_plane("two_pass", -1));
  Rig measure(device(), at_near_plane("two_pass", -1));
  const EyeView left = eye_view(measure.headset, sim::Eye::left, Pose{});
  const DepthRange depths = depth_range(left, measure.scene->volume.info(), measure.placement);
  ASSERT_GT(depths.near_m, 0.2);
  ASSERT_LT(depths.near_m, 0.3);
  // The least number of layers whose near plane is not beyond it.
  const auto near_plane = [&](int layers) {
    return plan_single_pass(device(), at_near_plane("layers", layers), measure.headset,
                            measure.scene->volume.info(), measure.placement)
        .near_m;
  };
  int needed = 2;
  while (near_plane(needed) > depths.near_m)
    ++needed;
  ASSERT_GT(needed, 4);

  Rig enough(device(), at_near_plane("layers", needed));
  EXPECT_LE(dssim(enough.render(device())[1], two[1]), 0.02);
  EXPECT_EQ(enough.renderer.stereo_note().find("cast twice"), std::string::npos);

  Rig too_few(device(), at_near_plane("layers", needed - 1));
  EXPECT_EQ(too_few.render(device())[1].pixels, two[1].pixels);
  EXPECT_THAT(too_few.renderer.stereo_note(), HasSubstr("1 of 1 eye frames were ray cast twice"));
}

TEST_F(StereoExtremes, LinearInterpolationHalvesTheError) {
  const EyePictures two = render(still_session("two_pass", 96));
  Session published = still_session("layers", 96), linear = still_session("layers", 96);
  PipelineStage& stage = published.pipeline.at("stereo");
  ASSERT_TRUE(stage.set_choice("path_length", "reference") && stage.set_choice("holes", "none"));
  ASSERT_TRUE(linear.pipeline.at("stereo").set_choice("interpolation", "linear"));
  const double before = dssim(render(std::move(published))[1], two[1]);
  EXPECT_LT(dssim(render(std::move(linear))[1], two[1]), 0.5 * before);
}

TEST_F(StereoExtremes, FromTheMiddleBothEyesAreComposedAndLikeThoseOfTwoPasses) {
  // On the Vive the eyes' frusta are not alike.
  for (const char* profile : {"htc-vive", "valve-index"}) {
    const auto on = [&](const char* stereo, const char* reference) {
      Session session = still_session(stereo, 96);
      session.device.profile = profile;
      if (reference != nullptr) {
        EXPECT_TRUE(session.pipeline.at("stereo").set_choice("reference", reference));
      }
      return session;
    };
    Rig twice(device(), on("two_pass", nullptr));
    const EyePictures two = twice.render(device());
    const WorkCounts twice_work = twice.renderer.render({}, twice.eyes).work;
    for (const char* stereo : {"layers", "novel_view"}) {
      Rig once(device(), on(stereo, "middle"));
      const EyePictures one = once.render(device());
      for (std::size_t eye = 0; eye < 2; ++eye) {
        EXPECT_LE(dssim(one[eye], two[eye]), 0.003) << profile << " " << stereo << " " << eye;
        EXPECT_GT(dssim(one[eye], two[1 - eye]), 0.03) << "the eyes see alike: nothing is proved";
      }
      EXPECT_LT(static_cast<double>(once.renderer.render({}, once.eyes).work.samples),
                0.53 * static_cast<double>(twice_work.samples))
          << profile << " " << stereo;
    }
    const auto plan = [&](const char* reference) {
      return plan_single_pass(device(), on("layers", reference), twice.headset, twice.scene->volume.info(),
                              twice.placement);
    };
    // Half as far away, an eye needs half of the layers.
    EXPECT_LE(plan("middle").layers, plan("left").layers / 2 + 1) << profile;
  }
}

TEST_F(StereoExtremes, LinearInterpolationFromTheMiddleHalvesTheErrorOfBothEyes) {
  const EyePictures two = render(still_session("two_pass", 160));
  Session near = still_session("layers", 160), linear = still_session("layers", 160);
  ASSERT_TRUE(near.pipeline.at("stereo").set_choice("reference", "middle") &&
              linear.pipeline.at("stereo").set_choice("reference", "middle") &&
              linear.pipeline.at("stereo").set_choice("interpolation", "linear"));
  const EyePictures before = render(std::move(near)), after = render(std::move(linear));
  double error_before = 0.0, error_after = 0.0;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    error_before += dssim(before[eye], two[eye]);
    error_after += dssim(after[eye], two[eye]);
  }
  EXPECT_LT(error_after, 0.6 * error_before);
}

TEST_F(StereoExtremes, InterleavedRaysTakeAQuarterOfTheMemory) {
  const EyePictures two = render(still_session("two_pass", 96));
  Session session = still_session("layers", 96);
  ASSERT_TRUE(session.pipeline.at("stereo").set("interleave", 2));
  Rig rig(device(), std::move(session)), whole(device(), still_session("layers", 96));
  const auto bytes = [&](Rig& of) {
    return plan_single_pass(device(), of.session, of.headset, of.scene->volume.info(), of.placement).bytes;
  };
  EXPECT_LT(static_cast<double>(bytes(rig)), 0.3 * static_cast<double>(bytes(whole)));
  EXPECT_LE(dssim(rig.render(device())[1], two[1]), 0.05);
}

/// Segments of the left eye's rays of a row, by the oracle's ray caster.
std::vector<std::vector<ScanSegment>> segments_of_row(const Rig& rig, const Volume& volume,
                                                      const EyeView& left, int first, int count, int row) {
  constexpr double step = 0.5;
  const double unit_m = metres_per_unit(volume.info, rig.placement);
  std::vector<std::vector<ScanSegment>> rays;
  for (int i = 0; i < count; ++i) {
    const reference::Ray ray = reference::ray_through_pixel(left, volume.info, rig.placement, first + i, row);
    const double x = left.tan_left + (first + i + 0.5) / left.width_px * (left.tan_right - left.tan_left);
    const double y = left.tan_top + (row + 0.5) / left.height_px * (left.tan_bottom - left.tan_top);
    const double along = 1.0 / std::sqrt(1.0 + x * x + y * y);  // depth per length
    std::vector<ScanSegment> segments;
    for (int k = 0; k * step < ray.length; ++k) {
      const double begin = k * step, end = std::min(begin + step, ray.length);
      const double value = reference::value_at(volume, ray.entry + 0.5 * (begin + end) * ray.direction);
      const TransferSample sample = lookup(rig.scene->table, value);
      if (!(sample.kappa > 0.0)) continue;
      segments.push_back({(ray.distance_m + begin * unit_m) * along,
                          (ray.distance_m + end * unit_m) * along,
                          {sample.r, sample.g, sample.b},
                          sample.kappa * (end - begin)});
    }
    rays.push_back(std::move(segments));
  }
  return rays;
}

TEST_F(StereoExtremes, ThePlainSchemeIsTheScanLineOracle) {
  for (const char* name : {"generator:nested_shells:24", "generator:fractal_vessels:24"}) {
    Session session = still_session("layers", 64);
    session.scene.volume = name;
    PipelineStage& stage = session.pipeline.at("stereo");
    ASSERT_TRUE(stage.set_choice("path_length", "reference") && stage.set_choice("holes", "none") &&
                stage.set_choice("format", "rgba32f") &&
                session.pipeline.at("cast").set("termination_opacity", 1.0));
    Rig rig(device(), std::move(session), alike);
    const ImageRgba8 composed = rig.render(device())[1];
    const Volume volume = load_volume(*open_volume(name));
    const EyeView left = eye_view(rig.headset, sim::Eye::left, Pose{});
    const StereoGeometry geometry = stereo_geometry(left, eye_view(rig.headset, sim::Eye::right, Pose{}));
    ASSERT_EQ(geometry.row_shift, 0.0);
    int visible = 0, off = 0;
    for (int y = 0; y < composed.height_px; ++y) {
      const auto rays = segments_of_row(rig, volume, left, -32, 128, y);
      const auto row = compose_scan_line(geometry, {-32, rays}, composed.width_px);
      for (int x = 0; x < composed.width_px; ++x) {
        const glm::dvec4 expected = 255.0 * row[static_cast<std::size_t>(x)];
        const Rgba8& found = composed.at(x, y);
        visible += expected.a > 5.0;
        const std::array<double, 4> apart = {found.r - expected.r, found.g - expected.g, found.b - expected.b,
                                             found.a - expected.a};
        const double most = std::abs(*std::max_element(
            apart.begin(), apart.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
        off += most > 2.5;  // half a level is rounding
      }
    }
    EXPECT_GT(visible, 300) << name;
    EXPECT_EQ(off, 0) << name;
  }
}

}  // namespace
}  // namespace brace
