// rays/mab on the device: where levels fade into each other nothing is seen of it on a smooth scene.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/replay/eye_renderer.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"
#include "tests/unit/stereo_matrix/stereo_session.hpp"

namespace brace {
namespace {

using namespace test;

/// Homogeneous fog in a wide flat box that fills the view: its opacity is a smooth function of the angle.
Session smooth_session(const std::string& rays, const char* map, const char* filter) {
  Session session = stereo_session({{"rays", rays},
                                    {"skip", "none"},
                                    {"stereo", "two_pass"},
                                    {"schedule", "whole_frame"},
                                    {"warp", "none"}});
  const std::filesystem::path fog = std::filesystem::path(testing::TempDir()) / "smooth_fog.toml";
  std::ofstream(fog) << "domain = 'fraction'\nabsorption_unit = 'per_metre'\n"
                        "points = [{ value = 0.0, r = 1.0, g = 0.5, b = 0.25, absorption = 2.0 },\n"
                        "          { value = 1.0, r = 1.0, g = 0.5, b = 0.25, absorption = 2.0 }]\n";
  session.device.resolution_scale = 160.0 / 1080.0;
  session.scene.volume = "generator:slab:64x64x8";
  session.scene.transfer_function = fog.string();
  session.scene.size_m = 4.0;
  session.scene.position = "front:0.5";
  if (rays == "mab") {
    PipelineStage& stage = session.pipeline.at("rays");
    EXPECT_TRUE(stage.set_choice("map", map) && stage.set_choice("filter", filter));
  }
  return session;
}

ImageRgba8 left_picture(const gpu::Device& device, const Session& session, const Headset& headset) {
  const VolumePlacement placement = place_volume(session.scene, Pose{});
  const EyePair eyes = make_eye_pair(device, session, headset);
  const auto scene = load_scene(device, session, {.data_folder = data}, headset, placement);
  EyeRenderer renderer(device, session, headset, *scene, placement, data, EyeRenderer::Counting::off);
  renderer.render(Pose{}, eyes);
  ImageRgba8 image(headset.eye.width_px, headset.eye.height_px);
  gpu::download_values<Rgba8>(device, eyes[0].image, image.pixels);
  return image;
}

/// Steps of the opacity between neighbours, where two levels share one of them and elsewhere.
struct Gradients {
  int largest_in_blend = 0, largest_elsewhere = 0;
  int most_off_in_blend = 0;  // from those of a ray per pixel
  int pairs_in_blend = 0;
};

Gradients gradients_of(const ImageRgba8& image, const ImageRgba8& full, const MabPlan& plan) {
  const std::vector<float>& coordinates = plan.coordinates(sim::Eye::left);
  const LevelWeights weights = plan.weights(sim::Eye::left, plan.step_asked(1.0));
  const auto blends = [&](int x, int y) {
    const float place = coordinates[static_cast<std::size_t>(y * image.width_px + x)];
    const std::uint32_t range =
        weights.ranges[std::min<std::size_t>(static_cast<std::size_t>(place * 255.0f), 254)];
    return (range & 0xffu) != range >> 8;
  };
  Gradients found;
  for (int y = 0; y + 1 < image.height_px; ++y) {
    for (int x = 0; x + 1 < image.width_px; ++x) {
      for (const auto& [beside_x, beside_y] : {std::pair(x + 1, y), std::pair(x, y + 1)}) {
        const int step = image.at(beside_x, beside_y).a - image.at(x, y).a;
        const int step_full = full.at(beside_x, beside_y).a - full.at(x, y).a;
        if (!blends(x, y) && !blends(beside_x, beside_y)) {
          found.largest_elsewhere = std::max(found.largest_elsewhere, std::abs(step));
          continue;
        }
        ++found.pairs_in_blend;
        found.largest_in_blend = std::max(found.largest_in_blend, std::abs(step));
        found.most_off_in_blend = std::max(found.most_off_in_blend, std::abs(step - step_full));
      }
    }
  }
  return found;
}

class MabPicture : public gpu::GpuTest {};

TEST_F(MabPicture, LevelsFadeWithoutASeam) {
  const Session by_pixel = smooth_session("full_rate", "", "");
  const Headset headset = make_headset(by_pixel.device, data);
  const ImageRgba8 full = left_picture(device(), by_pixel, headset);
  for (const char* map : {"radius", "eccentricity"}) {
    for (const char* filter : {"linear", "catmull_rom"}) {
      const Session session = smooth_session("mab", map, filter);
      const Gradients found =
          gradients_of(left_picture(device(), session, headset), full, plan_mab(session, headset).value());
      EXPECT_GT(found.pairs_in_blend, 1000) << map;
      EXPECT_GE(found.largest_elsewhere, 1) << "nothing varies: nothing is proved";
      EXPECT_LE(found.largest_in_blend, found.largest_elsewhere) << map << " " << filter;
      EXPECT_LE(found.most_off_in_blend, 1) << map << " " << filter;  // rounding
    }
  }
}

}  // namespace
}  // namespace brace
