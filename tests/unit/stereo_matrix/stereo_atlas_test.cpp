// Single-pass stereo over the atlas of rays/mab: the same levels as two passes, one eye's rays.
#include <array>
#include <string>

#include <gmock/gmock.h>

#include "runtime/metrics/image_error.hpp"
#include "runtime/replay/eye_renderer.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"
#include "tests/unit/stereo_matrix/stereo_session.hpp"

namespace brace {
namespace {

using namespace test;
using ::testing::HasSubstr;

using AtlasPictures = std::array<ImageRgba8, 2>;

struct AtlasSettings {
  std::string stereo = "layers", reference = "left", holes = "fresh_rays", interpolation = "nearest";
  int interleave = 1;
  std::string map = "radius", scheme = "compact", filter = "linear";
  double across_px = 96.0;
  std::string profile = "htc-vive", volume = "generator:fractal_vessels:24";
};

Session atlas_session(const AtlasSettings& settings) {
  Session session = stereo_session({{"rays", "mab"},
                                    {"skip", "none"},
                                    {"stereo", settings.stereo},
                                    {"schedule", "whole_frame"},
                                    {"warp", "none"}});
  session.device.profile = settings.profile;
  session.device.resolution_scale = settings.across_px / 1080.0;
  session.scene.volume = settings.volume;
  session.full_rate = stage_named("rays", "full_rate");
  PipelineStage& rays = session.pipeline.at("rays");
  EXPECT_TRUE(rays.set_choice("map", settings.map) && rays.set_choice("scheme", settings.scheme) &&
              rays.set_choice("filter", settings.filter));
  PipelineStage& stereo = session.pipeline.at("stereo");
  if (settings.stereo != "two_pass") {
    EXPECT_TRUE(stereo.set_choice("reference", settings.reference));
  }
  if (settings.stereo == "layers") {
    EXPECT_TRUE(stereo.set_choice("holes", settings.holes) &&
                stereo.set_choice("interpolation", settings.interpolation) &&
                stereo.set("interleave", settings.interleave));
  }
  return session;
}

struct AtlasRig {
  AtlasRig(const gpu::Device& on, const AtlasSettings& settings)
      : device(on),
        session(atlas_session(settings)),
        headset(make_headset(session.device, data)),
        placement(place_volume(session.scene, Pose{})),
        eyes(make_eye_pair(device, session, headset)),
        scene(load_scene(device, session, {.data_folder = data}, headset, placement)),
        renderer(device, session, headset, *scene, placement, data, EyeRenderer::Counting::on) {}

  AtlasPictures pictures() const {
    AtlasPictures both = {ImageRgba8(headset.eye.width_px, headset.eye.height_px),
                          ImageRgba8(headset.eye.width_px, headset.eye.height_px)};
    for (std::size_t eye = 0; eye < 2; ++eye)
      gpu::download_values<Rgba8>(device, eyes[eye].image, both[eye].pixels);
    return both;
  }
  AtlasPictures render(double quality = 1.0) {
    work = renderer.render(Pose{}, eyes, quality).work;
    return pictures();
  }

  const gpu::Device& device;
  Session session;
  Headset headset;
  VolumePlacement placement;
  EyePair eyes;
  std::unique_ptr<SceneOnDevice> scene;
  EyeRenderer renderer;
  WorkCounts work;
};

double off(const ImageRgba8& a, const ImageRgba8& b) {
  return dssim_from_ssim(ssim(a, b));
}

class StereoAtlas : public gpu::GpuTest {};

TEST_F(StereoAtlas, LayersAreLikeTwoPassesOverTheSameAtlas) {
  struct Case {
    AtlasSettings settings;
    double dssim_max = 0.004, samples_max = 0.6;
  };
  const Case cases[] = {
      {{}},
      {{.interpolation = "linear"}, 0.002},
      {{.map = "lens", .scheme = "discard", .filter = "catmull_rom"}},
      {{.reference = "middle"}},
      // Most of this picture is of the coarsest level, 29 texels across, and its borders are long.
      {{.reference = "middle", .interpolation = "linear", .map = "eccentricity"}, 0.012, 0.75}};
  for (const auto& [settings, dssim_max, samples_max] : cases) {
    AtlasSettings twice = settings;
    twice.stereo = "two_pass";
    AtlasRig two(device(), twice), one(device(), settings);
    for (const double quality : {1.0, 0.6}) {
      const AtlasPictures expected = two.render(quality), found = one.render(quality);
      const std::string which = settings.reference + " " + settings.interpolation + " " + settings.map;
      if (settings.reference == "left") {
        EXPECT_EQ(found[0].pixels, expected[0].pixels) << which;
      }
      EXPECT_GT(off(expected[0], expected[1]), 0.03) << "the eyes see alike: nothing is proved";
      for (std::size_t eye = 0; eye < 2; ++eye)
        EXPECT_LE(off(found[eye], expected[eye]), dssim_max) << which << " " << quality << " " << eye;
      EXPECT_LT(static_cast<double>(one.work.samples), samples_max * static_cast<double>(two.work.samples))
          << which << " " << quality;
    }
  }
}

TEST_F(StereoAtlas, TexelsWhoseRaysTheOtherEyeLacksGetRaysOfTheirOwn) {
  AtlasRig two(device(), {.stereo = "two_pass", .across_px = 200.0});
  AtlasRig fresh(device(), {.across_px = 200.0}), none(device(), {.holes = "none", .across_px = 200.0});
  const AtlasPictures expected = two.render();
  const double with = off(fresh.render()[1], expected[1]), without = off(none.render()[1], expected[1]);
  EXPECT_LT(with, 0.5 * without);
  EXPECT_GT(fresh.work.rays, none.work.rays);
  EXPECT_LT(static_cast<double>(fresh.work.rays), 1.15 * static_cast<double>(none.work.rays));
}

TEST_F(StereoAtlas, CellsFromTheMiddleChangeNoBit) {
  for (const char* stereo : {"layers", "novel_view"}) {
    AtlasRig two(device(), {.stereo = "two_pass"});
    AtlasRig whole(device(), {.stereo = stereo, .reference = "middle"});
    AtlasRig cells(device(), {.stereo = stereo, .reference = "middle"});
    const AtlasPictures expected = two.render(), at_once = whole.render();
    const JobOutcome outcome = cells.renderer.render_cells(Pose{}, cells.eyes, 1.0, {3, 3});
    const AtlasPictures in_cells = cells.pictures();
    EXPECT_EQ(outcome.cells.size(), 18u);
    EXPECT_EQ(outcome.work.samples, whole.work.samples) << stereo;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      EXPECT_EQ(in_cells[eye].pixels, at_once[eye].pixels) << stereo << " " << eye;
      EXPECT_LE(off(in_cells[eye], expected[eye]), 0.006) << stereo << " " << eye;
    }
  }
}

TEST_F(StereoAtlas, ExtremesStayWithinTheirBounds) {
  for (const AtlasSettings& settings :
       {AtlasSettings{.volume = "generator:slab:1"}, AtlasSettings{.interleave = 3},
        AtlasSettings{.across_px = 8.0}, AtlasSettings{.reference = "middle", .across_px = 8.0}}) {
    AtlasSettings twice = settings;
    twice.stereo = "two_pass";
    const AtlasPictures expected = AtlasRig(device(), twice).render();
    const AtlasPictures found = AtlasRig(device(), settings).render();
    EXPECT_LE(off(found[1], expected[1]), 0.06) << settings.volume << " " << settings.across_px;
  }
}

TEST_F(StereoAtlas, RectifiedEyesAreRefusedByName) {
  try {
    AtlasRig refused(device(), {.profile = "valve-index"});
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), HasSubstr("rays/mab"));
    EXPECT_THAT(error.what(), HasSubstr("canted"));
  }
}

}  // namespace
}  // namespace brace
