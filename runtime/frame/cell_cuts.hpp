#pragma once

#include <span>
#include <vector>

namespace brace {

/// Where an eye's rays are cut into cells: into bands from top to bottom, and each band by itself from left
/// to right. Edges are shares of the height and of the width, rising from 0 to 1. Cell = band * columns +
/// column.
struct CellCuts {
  CellCuts() = default;
  /// Cells of one size.
  CellCuts(int columns, int rows);

  int columns = 0, rows = 0;
  std::vector<double> bands;            // rows + 1
  std::vector<double> columns_in_band;  // columns + 1 for each band

  struct Area {
    double left, top, right, bottom;
  };
  Area area(int cell) const;
};

/// Costs over an eye's rays, spread evenly within the cells they were taken for. Does not allocate after
/// construction.
class CostDensity {
 public:
  CostDensity(int columns, int rows);

  /// `costs` of the cells of `cuts`, not negative. `even_share`: so much of their sum is laid under all of
  /// it.
  void set(const CellCuts& cuts, std::span<const double> costs, double even_share = 0.0);

  double sum() const { return above(1.0); }
  double above(double y) const;
  /// Between two heights, left of x.
  double left_of(double top, double bottom, double x) const;
  double in(const CellCuts::Area& area) const;

 private:
  CellCuts cuts_;
  std::vector<double> above_band_;    // costs above each edge of a band
  std::vector<double> left_of_edge_;  // costs of a band left of each of its edges
  double even_ = 0.0;
};

/// Cuts `into` so that every band takes the same share of the costs, and every cell the same of its band.
/// Costs that sum up to nothing give even cuts. Does not allocate.
void cut_by_cost(const CostDensity& costs, CellCuts& into);

}  // namespace brace
