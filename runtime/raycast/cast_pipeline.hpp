#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "plugins/abi/brace_stage.h"
#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/pipeline.hpp"
#include "runtime/metrics/frame_record.hpp"
#include "runtime/raycast/eye_view.hpp"
#include "runtime/raycast/shading.hpp"
#include "runtime/raycast/transfer_on_device.hpp"
#include "runtime/raycast/volume_on_device.hpp"

namespace brace {

/// Binding slots of the kernels; brace/frame.glsl is the same list.
struct CastSlot {
  static constexpr std::uint32_t eye = 0, ray_entry = 1, ray_direction = 2, result_colour = 3,
                                 result_depth = 4, volume = 5, transfer = 6, counters = 7, eye_image = 8,
                                 eye_depth = 9, transfer_integrals = 40, transfer_segments = 41;
};

/// What cast kernels are put together from.
struct CastParts {
  std::filesystem::path glsl_folder;     // with brace/*.glsl
  std::filesystem::path kernels_folder;  // with *_main.comp
  /// Answers stage/parameters.glsl (the parameters of all stages as specialisation constants) and the stages'
  /// snippets stage/rays.glsl, stage/cast.glsl, stage/skip.glsl, stage/stereo.glsl. A stage that has nothing
  /// for the cast kernel is an empty text.
  gpu::IncludeResolver stages;
  std::vector<gpu::SpecConstant> constants;  // values of the parameters
  bool phong = false;                        // otherwise no gradient is in the kernel
  bool counters = false;                     // count rays, samples, skip steps and shading fetches
  /// Native stages stand in their place: no kernels are composed, and the pipeline must not record them.
  bool native_rays = false, native_cast = false;
  bool replays_segments = false;  // of a native cast on the host: SegmentReplay
  bool layers_by_ray = false;     // closing tells which ray's layers stand for a pixel
  SampledShading sampled = {};    // instead of phong
};

/// Kernels whose place native stages take have an empty text.
struct CastKernels {
  gpu::KernelDescription opening, cast, closing;
};

CastKernels compose_cast_kernels(const CastParts& parts, const VolumeOnDevice& volume);

/// Layers of emission and absorption along rays, for warps that take them.
struct RayLayers {
  int count = 0;           // per ray; 0: none
  std::uint64_t rays = 0;  // 0: one per pixel, and no table from pixels to rays
};

/// The picture of one eye in one eye-frame slot.
struct EyeTarget {
  EyeTarget() = default;
  EyeTarget(const gpu::Device& device, int width_px, int height_px, RayLayers layers = {});

  int width_px = 0, height_px = 0;
  gpu::Buffer image;  // a uint per pixel, rows top to bottom: premultiplied RGBA8, r lowest
  gpu::Buffer depth;  // a float per pixel: metres from the eye to the first visible sample, or +inf
  gpu::TexelBuffer image_texels;  // R32_UINT
  gpu::TexelBuffer depth_texels;  // R32_SFLOAT
  gpu::Buffer params;             // BraceEyeParams
  gpu::Buffer layers;             // 16 bytes per ray and layer; empty without
  gpu::Buffer layer_rays;  // a uint per pixel: the ray whose layers stand for it; empty if rays are pixels
};

/// The rays of one eye and what became of them: scratch, shared by all eyes and slots. A ray is two vec4
/// (entry in voxel coordinates and length in units; direction in voxels per unit and level), a result is a
/// premultiplied rgba32f colour and a depth in metres.
struct RayBuffers {
  RayBuffers() = default;
  /// Throws device_error when a buffer would be larger than what the device binds (lavapipe: 8 million rays).
  /// `guard_bytes` lie unused behind the results, for a watchdog.
  RayBuffers(const gpu::Device& device, int across, int down, std::uint64_t guard_bytes = 0);

  int across = 0, down = 0;
  gpu::Buffer entries, directions, colours, depths_m;
};

/// Another grid of rays than one per pixel of the image: with `left` rays before its first column and `top`
/// above it, or with no place in it at all (rays/mab).
struct RayGrid {
  int across = 0, down = 0;
  int left = 0, top = 0;
};

/// A rectangle of the ray grid.
struct CastArea {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The skip stage's map in buffers, for casts on the host; kernels get it by their bindings.
struct SkipMapBuffers {
  brace_skip_map kind = BRACE_SKIP_MAP_NONE;
  const gpu::Buffer* words = nullptr;
  const gpu::Buffer* params = nullptr;  // BraceSkipParams
};

/// Opening brace, ray casting and closing brace. The device must outlive it.
class CastPipeline {
 public:
  CastPipeline() = default;
  CastPipeline(const gpu::Device& device, const CastKernels& kernels,
               const gpu::CompileOptions& options = {});

  /// Sets where the eye is; what `commands` recorded before reads it too, so nothing may be in flight.
  /// `grid`: where a rays or stereo stage wants another one; one ray per pixel without.
  static void set_eye(const gpu::Device& device, const EyeTarget& target, const EyeView& eye,
                      const VolumePlacement& placement, const VolumeOnDevice& volume,
                      const TransferOnDevice& transfer, const std::optional<RayGrid>& grid = {});

  /// Everything that the kernels read and write, beside the bindings of other stages.
  struct Resources {
    const VolumeOnDevice& volume;
    const TransferOnDevice& transfer;
    const RayBuffers& rays;
    const EyeTarget& target;
    std::span<const gpu::Binding> more = {};  // skip maps, layers, …
    SkipMapBuffers skip_map = {};
    std::optional<RayGrid> grid = {};  // the part of `rays` in use; all of them without
    bool cast_twice =
        false;  // a stage wants to know of a ray's result before it is cast: layers of equal shares

    int rays_across() const { return grid ? grid->across : rays.across; }
    int rays_down() const { return grid ? grid->down : rays.down; }
  };

  /// Records one eye whole, with the timings "opening", "cast" and "closing" and barriers around each.
  void record(gpu::CommandList& commands, const Resources& resources) const;

  /// The three parts by themselves, without barriers or timings; `area` in rays, or in pixels for the
  /// closing.
  void record_opening(gpu::CommandList& commands, const Resources& resources, const CastArea& area) const;
  void record_cast(gpu::CommandList& commands, const Resources& resources, const CastArea& area) const;
  void record_closing(gpu::CommandList& commands, const Resources& resources, const CastArea& area) const;

  /// False for a native cast of which nobody wants segments.
  bool has_cast_kernel() const { return cast_.handle() != nullptr; }

  /// Sum of the work counted since the last reset; zero without CastParts::counters. After the work is done.
  WorkCounts counted(const gpu::Device& device) const;
  void reset_counters(const gpu::Device& device) const;
  /// As brace/counters.glsl lays them out, for native stages.
  const gpu::Buffer& counters() const { return counters_; }

 private:
  void dispatch(gpu::CommandList& commands, const gpu::ComputePipeline& pipeline, const Resources& resources,
                const CastArea& area) const;

  gpu::ComputePipeline opening_, cast_, closing_;
  gpu::Buffer counters_;
};

}  // namespace brace
