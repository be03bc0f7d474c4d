#pragma once

#include <array>
#include <optional>

#include "runtime/replay/headset.hpp"
#include "runtime/replay/native_warp.hpp"
#include "runtime/warp_layers/novel_view.hpp"

namespace brace {

/// The box of a scene's volume.
NovelView::Box box_of(const ActivationInput& input);

/// A warp that takes layers: a picture of the eye frame's size for each eye, which the display then shows as
/// it is. The device must outlive it.
class LayerWarp {
 public:
  /// `input`: of the scene, whose volume the layers were cast from.
  LayerWarp(const gpu::Device& device, const PipelineStage& warp, const ActivationInput& input,
            const Headset& headset, const std::filesystem::path& data_folder);

  /// Records one eye, with barriers around.
  void record(gpu::CommandList& commands, const Headset& headset, const EyeWarp& warp, const EyeTarget& from);
  const gpu::TexelBuffer& picture(sim::Eye eye) const {
    return pictures_[static_cast<std::size_t>(eye)].image_texels;
  }

  /// Takes the counts of both eyes' last pictures, once they are done.
  void take_counts();
  /// Texels written, and segments of rays: each looks into a pixel's layers. Of the last picture.
  std::uint64_t texels() const { return texels_; }
  /// Of all pictures.
  const NovelView::Counts& counts() const { return counts_; }

 private:
  const gpu::Device& device_;
  PipelineStage warp_;
  std::filesystem::path data_folder_;
  NovelView::Box box_;
  std::array<std::optional<NovelView>, 2>
      views_;  // made for the first eye frame, which tells whose layers a pixel has
  std::array<EyeTarget, 2> pictures_;
  std::array<gpu::Buffer, 2> scan_fractions_;  // of their pixels; for warps by line
  std::uint64_t pixels_ = 0;                   // of both eyes
  std::uint64_t texels_ = 0;
  NovelView::Counts counts_;
};

}  // namespace brace
