#pragma once

#include <filesystem>

#include "runtime/gpu/pipeline.hpp"
#include "runtime/raycast/cast_pipeline.hpp"

namespace brace {

/// One eye's picture from that of the same eye on another plane, by the homography between them: colours with
/// a cubic, depths (which are distances from the eye, whatever the plane) of the nearest pixel. The device
/// must outlive it.
class PlaneResampler {
 public:
  struct Folders {
    std::filesystem::path glsl, kernels;  // of brace/*.glsl and of stereo/*.comp
  };
  /// `from` and `to`: one eye, in one place.
  PlaneResampler(const gpu::Device& device, const EyeView& from, const EyeView& to, const Folders& folders);

  /// Records it, after a barrier; pictures of the sizes of `from` and `to`.
  void record(gpu::CommandList& commands, const EyeTarget& from, const EyeTarget& to) const;

 private:
  int width_px_, height_px_;
  gpu::ComputePipeline pipeline_;
  gpu::Buffer params_;
};

}  // namespace brace
