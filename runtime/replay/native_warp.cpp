#include "runtime/replay/native_warp.hpp"

#include "runtime/raycast/native_steps.hpp"

namespace brace {

NativeWarp::NativeWarp(const gpu::Device& device, const PipelineStage& stage, const ActivationInput& input,
                       PictureSize eye)
    : stage_(stage, input) {
  const std::uint64_t bytes =
      4 * static_cast<std::uint64_t>(eye.width_px) * static_cast<std::uint64_t>(eye.height_px);
  for (std::size_t i = 0; i < images_.size(); ++i) {
    images_[i] = gpu::Buffer(device, "warped eye image", bytes, gpu::Memory::device);
    pictures_[i] = gpu::TexelBuffer(device, images_[i], gpu::Format::r32_uint);
  }
}

void NativeWarp::record(gpu::CommandList& commands, const Headset& headset, const EyeWarp& warp,
                        const EyeTarget& from) const {
  brace_warp_frame frame{};
  frame.struct_size = sizeof frame;
  frame.eye = static_cast<std::uint32_t>(warp.eye);
  frame.frame = static_cast<std::uint64_t>(warp.frame);
  frame.vsync_index = warp.vsync_index;
  frame.rendered = to_abi(eye_view(headset, warp.eye, warp.render_world_from_head));
  frame.world_from_eye =
      to_abi(compose(warp.warp_world_from_head, headset.profile.eye(warp.eye).head_from_eye));
  frame.eye_image = buffer_range(from.image);
  frame.eye_depth_m = buffer_range(from.depth);
  frame.warped_image = buffer_range(images_[static_cast<std::size_t>(warp.eye)]);
  commands.barrier();
  frame.commands = commands.hand_out();
  stage_->warp(frame);
  commands.barrier();
}

}  // namespace brace
