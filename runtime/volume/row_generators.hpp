#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "runtime/volume/generators.hpp"

namespace brace {

// The formulas of the generators, and the same formulas row by row with everything hoisted that a row shares.
// Coordinates are those of the unit cube.

double marschner_lobb(double x, double y, double z);
double solid_box(double x, double y, double z);
double nested_shells(double x, double y, double z);

/// A vessel's piece: a round cone from a to b.
struct VesselSegment {
  std::array<double, 3> a{}, b{};
  double radius_a = 0, radius_b = 0;
};

/// The tree of `fractal_vessels`, from a fixed seed.
std::vector<VesselSegment> vessel_tree();

/// 1 - (d / r)^2 inside a segment, d the distance from its axis and r its radius there; 0 outside; the
/// largest of all segments.
double vessels(std::span<const VesselSegment> tree, double x, double y, double z);

class RowGenerator {
 public:
  virtual ~RowGenerator() = default;
  virtual void start_slice(int z) = 0;
  /// Row y of the slice last started; `out` has dims[0] values.
  virtual void row(int y, std::span<double> out) = 0;
};

/// Null for an unknown name.
std::unique_ptr<RowGenerator> make_row_generator(const GeneratorSpec& spec);

}  // namespace brace
