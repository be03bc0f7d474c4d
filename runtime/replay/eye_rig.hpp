#pragma once

#include <memory>

#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/scene.hpp"

namespace brace {

/// A renderer for one session, with what it needs; the head of its placement stands at the origin.
struct EyeRig {
  EyeRig(const gpu::Device& device, const std::filesystem::path& data_folder, Session session_taken)
      : session(std::move(session_taken)),
        headset(make_headset(session, data_folder)),
        placement(place_volume(session.scene, Pose{})),
        scene(load_scene(device, session, {.data_folder = data_folder}, headset, placement)),
        renderer(device, session, headset, *scene, placement, data_folder, EyeRenderer::Counting::on),
        eyes(make_eye_pair(device, headset.eye)) {}

  JobOutcome render(double quality = 1.0) { return renderer.render(Pose{}, eyes, quality); }
  double pixels() const { return 2.0 * headset.eye.width_px * headset.eye.height_px; }

  Session session;
  Headset headset;
  VolumePlacement placement;
  std::unique_ptr<SceneOnDevice> scene;
  EyeRenderer renderer;
  EyePair eyes;
};

}  // namespace brace
