#pragma once

#include <array>

#include "runtime/frame/frame_work.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/scene.hpp"

namespace brace {

/// The pictures of both eyes, indexed by sim::Eye.
using EyePair = std::array<EyeTarget, 2>;

EyePair make_eye_pair(const gpu::Device& device, PictureSize size);

/// Ray casts both eyes of a head pose. Device, headset and scene must outlive it; it stays where it is.
class EyeRenderer {
 public:
  enum class Counting { off, on };

  /// `families`: the session's stages for rays, cast and skip are taken from its pipeline.
  EyeRenderer(const gpu::Device& device, const Session& session, const Headset& headset,
              const SceneOnDevice& scene, const VolumePlacement& placement,
              const std::filesystem::path& data_folder, Counting counting);

  JobOutcome render(const Pose& world_from_head, const EyePair& into);

 private:
  const gpu::Device& device_;
  const Headset& headset_;
  const SceneOnDevice& scene_;
  VolumePlacement placement_;
  Counting counting_;
  CastPipeline pipeline_;
  RayBuffers rays_;
  gpu::CommandList commands_;
};

}  // namespace brace
