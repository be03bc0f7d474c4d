#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/time.hpp"
#include "runtime/frame/cell_cuts.hpp"

namespace brace {

/// schedule/chunked: an eye frame is cast in cells, a grid of them over each eye's rays.
struct ChunkedParams {
  enum class Guard {
    clock,      // the next cell is submitted when the one before it is done and it fits what is left
    prediction  // as published: at the start of a period as many as are predicted to fit, in one batch
  };
  enum class Order {
    rows,  // left eye first, top to bottom
    cost,  // the dearest that fits
    gaze   // from the middle of both eyes' pictures outwards
  };
  enum class Cut {
    even,  // cells of one size
    cost   // anew for every frame, so that cells are predicted to take the same
  };
  int columns = 8, rows = 8;  // of each eye
  Guard guard = Guard::clock;
  Order order = Order::rows;
  double bias = 1.0;                     // factor on every prediction
  std::optional<SimDuration> reserve{};  // before a vsync, for its warp; default: the warp's own lead
  SimDuration cell_overhead{10'000};     // GPU time that each cell takes beside its work
  Cut cut = Cut::even;
  int give_up_periods = 0;  // a frame not done after so many is given up if one of the rays that load control
                            // then asks for is done sooner; 0: never
  bool own_poses = false;   // each cell is cast from the pose that is predicted when it is submitted
  bool swap_cells = false;  // and shown as soon as it is done, between cells of the frame before
};

/// Which cell of an eye frame is cast next, and how long it is expected to take. A cell's time is traced from
/// frame to frame and predicted from its neighbourhood: bias * mean over the neighbours j of max(T_i, T_j)
/// (Buchacher 2017, Algorithm 5). Behind a clock guard what the last cells took over what was predicted is a
/// further factor: it grows at once and halves its distance to the newest ratio with each cell.
/// Does not allocate after construction.
class CellSchedule {
 public:
  explicit CellSchedule(const ChunkedParams& params);

  int cells() const { return static_cast<int>(traced_.size()); }

  /// All cells are to be cast again; with Cut::cost they are other ones.
  void begin_frame();
  /// Of this frame's cells, the left eye's and the right eye's.
  std::span<const CellCuts, 2> cuts() const { return cuts_; }
  /// None of this frame's cells is to be cast any more.
  void drop() {
    std::fill(waiting_.begin(), waiting_.end(), false);
    left_ = 0;
  }
  /// Of this frame.
  int left() const { return left_; }

  struct Cell {
    int number = 0;
    SimDuration predicted{0};
  };
  /// The next cell that is predicted to take at most `budget`; in an order of its own the head of the order
  /// alone is looked at. Empty: none fits, or none is left.
  std::optional<Cell> next(SimDuration budget) const;
  /// The cell to cast when one must be cast whatever it takes: the head of the order, or the cheapest.
  std::optional<Cell> next_in_any_case() const;
  void hand_out(const Cell& cell);

  /// A cell is done; `predicted` is what hand_out was told.
  void trace(const Cell& cell, SimDuration cost);

 private:
  SimDuration from_neighbourhood(int cell) const;
  Cell predict(int cell) const;
  void cut();
  double off_axis(int cell) const;

  ChunkedParams params_;
  std::array<CellCuts, 2> cuts_;
  CostDensity density_;
  std::vector<double> costs_ns_;  // of an eye's cells
  std::vector<SimDuration> traced_;
  std::vector<int> order_;  // cells, in the order of this frame
  std::vector<bool> waiting_;
  int left_ = 0;
  double growth_ = 1.0;
};

}  // namespace brace
