#pragma once

#include <array>
#include <optional>
#include <string>

#include "tools/live/overlay.hpp"
#include "tools/live/transfer_edit.hpp"

namespace brace {

/// The transfer function over the volume's histogram, by mouse: points are dragged, a double click sets one,
/// the right button takes one away. Height is the square root of a voxel length's opacity.
class TransferPanel {
 public:
  struct Change {
    std::optional<TransferFunction> edited;  // in data units, per voxel length
    std::string save_as;                     // "": not to be saved
  };
  explicit TransferPanel(std::string file) : file_(std::move(file)) {}

  /// Puts the widgets into the panel that is open. `resolved` is in force; `range` that of the table.
  Change show(Overlay& overlay, const TransferFunction& resolved, const VoxelStatistics& statistics,
              ValueRange range);

 private:
  void follow_mouse(TransferFunction& function, const WindowRect& plot, ValueRange range, Change& change);

  std::string file_;
  std::size_t selected_ = 0;
  bool dragging_ = false;
  std::vector<float> bars_;  // of the statistics with as many voxels and this range
  std::uint64_t bars_voxels_ = 0;
  ValueRange bars_range_;
};

/// Where a point is drawn, in window pixels.
std::array<float, 2> place_of(const TransferPoint& point, const WindowRect& plot, ValueRange range);

}  // namespace brace
