#pragma once

#include <array>
#include <vector>

#include "runtime/volume/transfer_function.hpp"

namespace brace {

// Pre-integrated transfer functions (Engel, Kraus, Ertl 2001): along a segment the value is taken to be
// linear between its ends, and the transfer function is integrated over the values in between. So a band
// narrower than what two samples are apart is seen.
//
// Optical depths are in powers of two, as the kernels have them: transmittance = 2^-w.

/// Optical depth of a step beyond which nothing is told apart: even a band of one entry out of 4,096 leaves a
/// transmittance of 2^-256. Integrals stay within what a pair of floats holds.
inline constexpr double integral_depth_max = 1 << 20;

/// Per entry i of a table: the integrals from 0 to i over the table coordinate u of w r, w g, w b and w, w
/// being the optical depth of one step, colour and w each linear between entries (so the integrals are
/// exact).
using TransferIntegrals = std::vector<std::array<double, 4>>;
TransferIntegrals integrate(const TransferTable& table, double step_units);

/// The integrals up to any coordinate in [0, N - 1].
std::array<double, 4> integral_up_to(const TransferIntegrals& integrals, const TransferTable& table,
                                     double step_units, double coordinate);

/// Nodes along an edge of the two-dimensional table: an entry of the transfer table each where there are few.
int segment_table_size(const TransferTable& table);

/// The two-dimensional table: premultiplied colour and opacity of one full step along which the coordinate
/// goes from node `front` to node `back`, at [back * size + front]; what lies behind is dimmed by what lies
/// before it within the step. Rounded to float.
std::vector<std::array<float, 4>> preintegrated_segments(const TransferTable& table,
                                                         const TransferIntegrals& integrals,
                                                         double step_units, int size);

}  // namespace brace
