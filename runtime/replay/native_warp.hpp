#pragma once

#include <array>

#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/scene_activation.hpp"

namespace brace {

/// One display image's part of one eye: which eye frame is shown, and where the head will be.
struct EyeWarp {
  sim::Eye eye = sim::Eye::left;
  Pose render_world_from_head{}, warp_world_from_head{};
  std::int64_t frame = 0;
  std::int64_t vsync_index = 0;
  ScanPoses warp_scan{};  // for warps by line
};

/// A native warp stage: it writes a picture of the eye frame's size, which the display then shows as it is.
/// The device must outlive it.
class NativeWarp {
 public:
  NativeWarp(const gpu::Device& device, const PipelineStage& stage, const ActivationInput& input,
             PictureSize eye);

  /// Records one eye, with barriers around. Throws device_error that names the stage when it fails.
  void record(gpu::CommandList& commands, const Headset& headset, const EyeWarp& warp,
              const EyeTarget& from) const;

  const gpu::TexelBuffer& picture(sim::Eye eye) const { return pictures_[static_cast<std::size_t>(eye)]; }

 private:
  ActiveStage stage_;
  std::array<gpu::Buffer, 2> images_;
  std::array<gpu::TexelBuffer, 2> pictures_;  // R32_UINT
};

}  // namespace brace
