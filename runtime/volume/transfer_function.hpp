#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/volume/volume.hpp"

namespace brace {

/// Closed interval of values in the data's own units (HU, grey values, ...).
struct ValueRange {
  double min = 0;
  double max = 0;
};

/// Colour and absorption at one value. Colour is display-referred, 0 .. 1, NOT premultiplied. `kappa` is the
/// absorption coefficient per voxel length (volume.hpp): a path of d voxel lengths has the opacity 1 -
/// exp(-kappa d).
struct TransferSample {
  double r = 0, g = 0, b = 0;
  double kappa = 0;
};

struct TransferPoint {
  double value = 0;
  TransferSample sample;
};

/// What `value` of a point means.
enum class ValueDomain : std::uint8_t {
  data,     // the data's own units
  fraction  // 0 .. 1 over the window if there is one, else over the data's range
};

/// What `kappa` of a point is per. Opacities are turned into per_voxel when they are read.
enum class AbsorptionUnit : std::uint8_t { per_voxel, per_metre };

/// Window and level in the data's own units: the interval [level - width / 2, level + width / 2].
struct Window {
  double level = 0;
  double width = 1;
};

/// A continuous, piecewise linear function of the value: r, g, b and kappa are each linear between the
/// points, and constant before the first and after the last. One point makes a constant function.
struct TransferFunction {
  std::string name;
  std::string source;  // file, for messages
  ValueDomain domain = ValueDomain::data;
  AbsorptionUnit unit = AbsorptionUnit::per_voxel;
  std::optional<Window> window;
  std::vector<TransferPoint> points;  // at least one, values strictly increasing
};

/// Largest absorption accepted, per voxel length or per metre.
inline constexpr double kappa_limit = 1e12;

/// Optical depth that stands for opacity 1: 24 ln 2, where 1 - exp(-tau) is the largest fp32 number below 1.
inline constexpr double opaque_optical_depth = 16.635532333438686;

/// kappa = -log1p(-opacity) / reference_length; opacity 1 and what comes near it is clamped to
/// opaque_optical_depth / reference_length. Throws unless 0 <= opacity <= 1 and reference_length > 0.
double kappa_from_opacity(double opacity, double reference_length);

/// Opacity of a path of `length`: -expm1(-kappa * length).
double opacity_from_kappa(double kappa, double length);

/// Opacity `alpha` of a step, for a step `rho` times as long: -expm1(rho * log1p(-alpha)). 0 stays 0 and 1
/// stays 1 for every rho > 0; rho = 0 gives 0.
double opacity_corrected(double alpha, double rho);

/// Throws brace::Error (exit code 2) naming `source`, the point and what is accepted: no points, values not
/// finite or not strictly increasing, colour outside 0 .. 1, kappa outside 0 .. kappa_limit, a window not
/// wider than 0.
void validate(const TransferFunction& tf);

/// Reads the TOML form that runtime/volume/transfer_functions/README.md describes. Errors name the file and
/// line.
TransferFunction parse_transfer_function(std::string_view toml_text, const std::string& source);

/// `path_or_preset` is a file (ends in .toml or names one) or a preset's name, which is
/// `preset_folder`/NAME.toml; an unknown name lists those there are.
TransferFunction load_transfer_function(const std::string& path_or_preset,
                                        const std::filesystem::path& preset_folder);

std::vector<std::string> list_transfer_functions(const std::filesystem::path& preset_folder);

/// Moves the function onto another window: fractions go over the new one; a function in data units is mapped
/// linearly, its first point to the window's lower and its last to its upper end.
TransferFunction with_window(const TransferFunction& tf, Window window);

/// The function in data units and per voxel length. `data_range` serves fractions without a window; an empty
/// range (a constant volume of value v) is read as [min(0, v), v], or [0, 1] when v is 0. `voxel_length_m`,
/// the length of a voxel in the scene, serves AbsorptionUnit::per_metre and must be > 0 then.
TransferFunction resolve(const TransferFunction& tf, ValueRange data_range, double voxel_length_m = 0);

/// A resolved function's value. NaN is empty: all zero.
TransferSample evaluate(const TransferFunction& resolved, double value);

/// A transfer function as a table of N entries, and the one definition of its lookup, which the GLSL kernel
/// and the double-precision reference both implement:
///
///   u = clamp((v - min) * ((N - 1) / (max - min)), 0, N - 1),  i = min(floor(u), N - 2),  f = u - i,
///   r, g, b, kappa = (1 - f) * entry[i] + f * entry[i + 1]   each by itself.
///
/// Colours are interpolated NOT premultiplied and kappa linearly (never opacity): so every sample stays
/// within the entries' colours, and C = c (1 - exp(-kappa d)) is bounded by max c. Give an empty point the
/// colour of its visible neighbour.
struct TransferTable {
  ValueRange range;                            // max > min
  std::vector<std::array<double, 4>> entries;  // r, g, b, kappa per voxel length; 256 .. 4096 of them
};

inline constexpr int min_table_entries = 256;
inline constexpr int max_table_entries = 4096;

/// Where a table's entries lie.
struct TableLayout {
  ValueRange range;
  int entries = min_table_entries;
};

/// The layout that puts an entry on every voxel value where that is possible: [0, 255] with 256 entries for
/// uint8; 16-bit data with a range of up to 4,095 an entry per value; everything else 4,096 over the data's
/// range.
TableLayout table_layout(VoxelType type, ValueRange data_range);

/// Entry i is the resolved function at min + (max - min) * i / (N - 1).
TransferTable bake(const TransferFunction& resolved, const TableLayout& layout);

/// The double-precision reference of the lookup. NaN is empty.
TransferSample lookup(const TransferTable& table, double value);

/// The entries rounded to float, r g b kappa, for a buffer or a texture.
std::vector<std::array<float, 4>> float_entries(const TransferTable& table);

/// True if a point with kappa > 0 lies between two entries that are both empty: a band too narrow for the
/// table, which would not be seen.
bool loses_a_point(const TransferFunction& resolved, const TransferTable& table);

}  // namespace brace
