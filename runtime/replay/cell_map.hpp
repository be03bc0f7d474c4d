#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "runtime/display/display_geometry.hpp"
#include "runtime/frame/cell_cuts.hpp"
#include "runtime/gpu/commands.hpp"

namespace brace {

/// One eye's picture whose cells were cast from poses of their own (schedule/chunked, poses = "cell"), as the
/// display kernel reads it: whose cell a pixel is, and from the new eye to the eye of each cell. The device
/// must outlive it.
class CellMap {
 public:
  CellMap(const gpu::Device& device, int width_px, int height_px);

  /// `world_from_old_eye`: a pose per cell of `cuts`. Nothing submitted may still read the last ones.
  void set(const CellCuts& cuts, std::span<const Pose> world_from_old_eye, const ScanEye& new_eye);

  std::array<gpu::Binding, 2> bindings() const;

 private:
  void mark_cells(const CellCuts& cuts);

  const gpu::Device& device_;
  int width_px_, height_px_;
  std::optional<CellCuts> marked_;  // the cuts that the pixels are marked with
  std::vector<float> transforms_;   // two of 4 x vec4 per cell: of the first and of the last line
  gpu::Buffer cells_, poses_;
  gpu::TexelBuffer cell_texels_;
};

}  // namespace brace
