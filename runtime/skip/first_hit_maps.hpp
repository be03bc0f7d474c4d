#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "plugins/abi/glsl/brace/skip_params.h"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/raycast/eye_view.hpp"
#include "runtime/skip/skip_kernels.hpp"

namespace brace {

struct PipelineStage;

/// What skip/occlusion is asked for; the margins are constants of its snippet.
struct OcclusionSettings {
  int tile_px = 4;          // 1 … 64
  int refresh_frames = 8;   // 0: never
  double move_m_max = 0.1;  // an eye that moved or turned farther remembers nothing
  double turn_rad_max = 0.8;
};

/// Throws input_error when a parameter is missing.
OcclusionSettings occlusion_settings(const PipelineStage& stage);

/// From the view that `seen` was cast from, as the snippet wants it; no tiles where `next` is too far from
/// it. `frame` counts eye frames. Voxel coordinates are those of the volume at `placement`.
BraceOcclusionParams occlusion_params(const EyeView& seen, const EyeView& next, const VolumeInfo& volume,
                                      const VolumePlacement& placement, const OcclusionSettings& settings,
                                      std::uint32_t frame);

/// What the last eye frame of each eye has shown to be empty: the first hits of its image tile by tile, with
/// the view and the transfer function they hold for (Mensmann, Ropinski and Hinrichs 2008). The kernels must
/// outlive it; one frame may be in flight.
class FirstHitMaps {
 public:
  FirstHitMaps(SkipKernels& kernels, const OcclusionSettings& settings, int width_px, int height_px);

  /// Before a cast of `eye` (0 or 1) is submitted: what it may know of the last one. Nothing at first, after
  /// a change of the transfer function, or after a jump.
  void aim(std::size_t eye, const EyeView& view, const VolumeInfo& volume, const VolumePlacement& placement,
           std::int64_t transfer_version);

  /// What the snippet binds; valid until the next call.
  std::span<const gpu::Binding> bindings(std::size_t eye);

  /// After the closing brace of the eye last aimed, behind a barrier: keeps its first hits, with the timing
  /// "first hits" and a barrier at the end. Without it the eye's next frame knows nothing.
  void record(gpu::CommandList& commands, std::size_t eye, const EyeTarget& target);

  /// The next frame of either eye knows nothing.
  void forget();

  std::uint64_t device_bytes() const;

 private:
  struct View {
    EyeView view;
    std::int64_t transfer_version = 0;
  };
  struct OfEye {
    gpu::Buffer hits, params;
    gpu::TexelBuffer hit_texels;
    std::optional<View> aimed, seen;
    double metres_per_unit = 1.0;
    std::uint32_t frame = 0;
  };
  SkipKernels* kernels_;
  OcclusionSettings settings_;
  std::array<std::uint32_t, 2> tiles_;
  std::array<OfEye, 2> eyes_;
  std::array<gpu::Binding, 2> bindings_;
};

}  // namespace brace
