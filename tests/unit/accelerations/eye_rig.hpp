#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include <gtest/gtest.h>

#include "runtime/replay/eye_renderer.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"

namespace brace {

inline const std::filesystem::path accelerations_data = BRACE_DATA_FOLDER;

inline PipelineStage accelerations_stage(const std::string& family, const std::string& name) {
  static const StageRegistry registry = [] {
    StageRegistry made;
    made.add_folder(accelerations_data / "stages");
    return made;
  }();
  PipelineStage chosen{registry.find(family, name, "test"), {}};
  for (const StageParameter& parameter : chosen.stage.parameters)
    chosen.values.push_back(parameter.default_value);
  return chosen;
}

/// Small pictures of a volume half a metre large, 0.8 m in front of the head that stands at the origin.
inline Session accelerations_session(const std::string& volume, const std::string& transfer,
                                     const std::string& skip = "none") {
  Session session;
  session.device = {.profile = "htc-vive",
                    .resolution_scale = 0.06,
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
  for (const auto& [family, name] : std::map<std::string, std::string>{
           {"rays", "full_rate"}, {"cast", "dvr"}, {"skip", skip}, {"stereo", "two_pass"}, {"warp", "none"}})
    session.pipeline[family] = accelerations_stage(family, name);
  return session;
}

/// A file with a transfer function that shows the upper part of the values, the more the higher.
inline std::string written_transfer(const std::string& name, double opacity) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / (name + ".toml");
  std::ofstream(file) << "name = \"" << name << "\"\ndomain = \"fraction\"\npoints = [\n"
                      << "  { value = 0.0, r = 0.2, g = 0.4, b = 0.6, opacity = 0.0 },\n"
                      << "  { value = 0.4, r = 0.2, g = 0.4, b = 0.6, opacity = 0.0 },\n"
                      << "  { value = 1.0, r = 1.0, g = 0.8, b = 0.2, opacity = " << opacity << " },\n]\n";
  return file.string();
}

/// Shows the inner shells, with empty space around them.
inline std::string upper_half() {
  return written_transfer("upper_half", 0.3);
}

inline Pose moved_head(double x_m, double y_m, double z_m, double turn_rad = 0.0) {
  return {glm::dquat(std::cos(turn_rad / 2.0), 0.0, std::sin(turn_rad / 2.0), 0.0),
          glm::dvec3(x_m, y_m, z_m)};
}

/// A renderer that remembers its last frame if the session's stages do.
class AccelerationsRig {
 public:
  AccelerationsRig(const gpu::Device& device, Session taken)
      : session(std::move(taken)),
        headset(make_headset(session.device, accelerations_data)),
        placement(place_volume(session.scene, Pose{})),
        scene(load_scene(device, session, {.data_folder = accelerations_data}, headset, placement)),
        renderer(device, session, headset, *scene, placement, accelerations_data, EyeRenderer::Counting::on,
                 nullptr, EyeRenderer::SecondEye::as_session, EyeRenderer::Layers::none,
                 EyeRenderer::RayHeat::none, EyeRenderer::History::as_session),
        eyes(make_eye_pair(device, headset.eye)),
        device_(device) {}

  WorkCounts render(const Pose& head) { return renderer.render(head, eyes).work; }

  /// Colours and depths of both eyes, bit for bit.
  std::vector<std::uint32_t> picture() const {
    std::vector<std::uint32_t> words;
    for (const EyeTarget& eye : eyes) {
      for (const gpu::Buffer* buffer : {&eye.image, &eye.depth}) {
        std::vector<std::uint32_t> part(buffer->size_bytes() / 4);
        gpu::download_values(device_, *buffer, std::span<std::uint32_t>(part));
        words.insert(words.end(), part.begin(), part.end());
      }
    }
    return words;
  }

  std::vector<Rgba8> left_pixels() const {
    std::vector<Rgba8> pixels(eyes[0].image.size_bytes() / 4);
    gpu::download_values(device_, eyes[0].image, std::span<Rgba8>(pixels));
    return pixels;
  }

  Session session;
  Headset headset;
  VolumePlacement placement;
  std::unique_ptr<SceneOnDevice> scene;
  EyeRenderer renderer;
  EyePair eyes;

 private:
  const gpu::Device& device_;
};

}  // namespace brace
