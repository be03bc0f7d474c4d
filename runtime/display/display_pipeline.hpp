#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/image.hpp"
#include "runtime/display/display_geometry.hpp"
#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/pipeline.hpp"
#include "runtime/metrics/frame_record.hpp"

namespace brace {

/// Binding slots of the display kernel; brace/warp.glsl is the same list.
struct DisplaySlot {
  static constexpr std::uint32_t params = 0, source_image = 1, panel_image = 2, panel_tiles = 3, counters = 4,
                                 source_depth = 5, first_of_warp = 6, cell_of_pixel = 14, cell_poses = 15;
};

/// What a display kernel is put together from.
struct DisplayParts {
  std::filesystem::path glsl_folder;     // with brace/*.glsl
  std::filesystem::path kernels_folder;  // with display_main.comp
  /// Answers stage/parameters.glsl and the warp stage's snippet stage/warp.glsl.
  gpu::IncludeResolver stages;
  std::vector<gpu::SpecConstant> constants;  // values of the parameters
  LensTraits lens;
  bool counters = false;    // count pixels that the eye frame does not cover, and those that the warp fills
  bool cell_poses = false;  // the eye frame's cells were cast from poses of their own
};

gpu::KernelDescription compose_display_kernel(const DisplayParts& parts);

/// One eye's panel image and what the kernel knows of that eye. The device must outlive it.
class PanelTarget {
 public:
  PanelTarget() = default;
  /// `skip_hidden`: leave out the tiles that the eye cannot see; they stay black.
  PanelTarget(const gpu::Device& device, const PanelEye& eye, const SourcePicture& source,
              bool skip_hidden = true);

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  /// Pixels from one row to the next, at least width_px: rows are padded to whole tiles.
  int pitch_px() const { return pitch_px_; }
  /// A uint per pixel: RGBA8, r in the lowest byte, alpha 255.
  const gpu::Buffer& image() const { return image_; }

  /// Poses of the eye when the source picture was rendered and now; nothing submitted may still read it.
  void set_poses(const gpu::Device& device, const Pose& world_from_old_eye, const Pose& world_from_new_eye);
  void set_poses(const gpu::Device& device, const Pose& world_from_old_eye, const ScanEye& new_eye);

  /// How far from the old eye all there is to see lies, metres: what warps that search in depth need not look
  /// beyond. Holds until it is set anew.
  struct SceneRange {
    double nearest_m = 0.0, farthest_m = 1e30;
  };
  void set_scene_range(const SceneRange& range) { scene_range_ = range; }

  /// Pixels of the panel that the kernel writes, and its texel fetches: counted work, known beforehand.
  std::uint64_t pixels_written() const { return pixels_written_; }
  std::uint64_t texel_fetches(const LensTraits& lens) const {
    return pixels_written_ * (lens.one_fetch ? 4 : 12);
  }

  /// The panel image, width_px x height_px, after the work is done.
  ImageRgba8 read(const gpu::Device& device) const;

 private:
  friend class DisplayPipeline;

  int width_px_ = 0, height_px_ = 0, pitch_px_ = 0;
  std::uint64_t pixels_written_ = 0;
  std::uint32_t tile_count_ = 0;
  BraceDisplayParams params_{};
  SceneRange scene_range_;
  gpu::Buffer image_, params_buffer_, tiles_;
  gpu::TexelBuffer tile_texels_;
};

/// Warp and lens distortion in one pass. The same kernel makes the ideal image, with warp/none from a picture
/// rendered at the pose of photon time. The device must outlive it.
class DisplayPipeline {
 public:
  DisplayPipeline() = default;
  DisplayPipeline(const gpu::Device& device, const gpu::KernelDescription& kernel,
                  const gpu::CompileOptions& options = {});

  /// Records one eye. `source`: R32_UINT texels, premultiplied RGBA8, rows top to bottom without padding, of
  /// the size the target was made for. `more`: what the warp stage binds. No barriers.
  void record(gpu::CommandList& commands, const PanelTarget& target, const gpu::TexelBuffer& source,
              std::span<const gpu::Binding> more = {}) const;

  /// Whether the warp stage reads depth: then `more` must bind DisplaySlot::source_depth, R32_SFLOAT texels.
  bool uses_depth() const { return pipeline_.uses(DisplaySlot::source_depth); }

  /// Pixels within the field of view, by their green, since the last reset; zero without
  /// DisplayParts::counters. After the work is done.
  struct Counts {
    std::uint64_t uncovered = 0;  // black: beyond the eye frame
    std::uint64_t filled = 0;     // disoccluded: the warp stage shows something else
  };
  Counts counted(const gpu::Device& device) const;
  void reset_counters(const gpu::Device& device) const;

 private:
  gpu::ComputePipeline pipeline_;
  gpu::Buffer counters_;
};

}  // namespace brace
