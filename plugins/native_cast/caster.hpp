// What the SIMD ray caster works on, and its entry: plain data, shared by all instruction sets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "brace_stage.h"
#include "glsl/brace/eye_params.h"
#include "glsl/brace/skip_params.h"

namespace native_cast {

/// Memory for many texels: huge pages where the system has them, as nearly every fetch meets another page.
class Texels {
 public:
  Texels() = default;
  /// Throws std::bad_alloc. Not initialised.
  explicit Texels(std::size_t count);

  std::uint32_t* data() const { return memory_.get(); }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(std::uint32_t* memory) const;
  };
  std::unique_ptr<std::uint32_t[], Free> memory_;
  std::size_t size_ = 0;
};

/// Voxels as 32-bit texels with an apron of edge voxels. Texel (x, y, z) stands for the point (x, y, z) of
/// voxel coordinates. 8-bit: the voxels x - 1 and x of the rows y - 1 and y, lowest byte first. 16-bit: the
/// voxels x - 1 and x of row y - 1. Float: voxel (x - 1, y - 1). All of slice z - 1.
///
/// In memory they lie in tiles of 4 x 4 columns; a slice of a tile is a cache line, the next slice the next
/// one: a packet of 4 x 4 rays meets few lines, whatever its direction.
struct PackedVolume {
  static constexpr std::int32_t tile_slice_texels = 16;

  brace_voxel_type type = BRACE_VOXEL_UINT8;
  alignas(16) std::int32_t last_cell[4] = {};  // along each axis: the last texel but one
  /// Texels from tile to tile along x and along y, from slice to slice along z, padding.
  alignas(16) std::int32_t pitch[4] = {0, 0, tile_slice_texels, 0};
  Texels texels;

  /// Reads and packs all slices. On failure `error` says why. May throw std::bad_alloc.
  brace_result read(const brace_volume& volume, std::string& error);
};

struct Shading {
  brace_shading kind = BRACE_SHADING_NONE;
  float ambient = 0.3f, diffuse = 0.7f, specular = 0.2f, shininess = 32.0f;  // phong
  int samples = 0;                                                           // random_lights
  float step_units = 1.0f;  // between additional samples: shadow_ao, random_lights
  float light[3] = {};      // shadow_ao: towards it, metric axes, length 1
};

/// From an entry of the transfer table to the next: r, g, b and the optical depth of a step in powers of two
/// at the entry, and how much more they are at the next.
struct alignas(32) TransferSegment {
  float entry[4], rise[4];
};

/// Everything the rays of one call have in common.
struct Scene {
  const PackedVolume* volume = nullptr;
  const TransferSegment* transfer_segments = nullptr;
  std::int32_t last_segment = 0;
  brace::BraceEyeParams eye{};
  brace_skip_map skip_map = BRACE_SKIP_MAP_NONE;
  const std::uint32_t* skip_words = nullptr;
  brace::BraceSkipParams skip{};
  float step_units = 0.5f;
  float opaque_transmittance = 0.0f;  // a ray ends at or below it; negative: never
  Shading shading;
  const brace_segment_sink* segments = nullptr;  // null: nobody asks for segments
};

/// The ray buffers of brace/ray_buffers.glsl.
struct Rays {
  const float* entries = nullptr;
  const float* directions = nullptr;
  float* colours = nullptr;
  float* depths_m = nullptr;
  std::size_t across = 0;  // rays per row
};

/// Casts the rays of `area` on this thread and adds to `counts`. What the scene's sink of segments returns,
/// else BRACE_OK. May throw std::bad_alloc where there is one.
brace_result cast_area(const Scene& scene, const Rays& rays, const brace_area& area,
                       brace_work_counts& counts);

/// Instruction sets that cast_area has code for and this processor runs, best first: "avx512", "avx2",
/// "sse4", "neon", "scalar".
std::vector<std::string> instruction_sets();
/// The one of the above that cast_area uses from now on in this process; "auto": the best.
void choose_instruction_set(const std::string& name);

}  // namespace native_cast
