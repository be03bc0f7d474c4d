#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "runtime/volume/volume.hpp"

namespace brace {

// Volumes with a formula: the formula is the oracle of the tests, the voxels are its samples at the voxel
// centres. A formula maps the unit cube (x, y, z in [0, 1] over the volume's box) to [0, 1]. Voxel (i, j, k)
// is f((i + 0.5) / dims[0], (j + 0.5) / dims[1], (k + 0.5) / dims[2]) times full_scale(type), rounded to
// nearest for the integer types.

struct GeneratorSpec {
  std::string name;
  std::array<int, 3> dims{64, 64, 64};
  VoxelType type = VoxelType::uint8;
};

struct GeneratorInfo {
  std::string name;
  std::string help;  // one line
};

/// The names that a spec accepts, in the order they are listed in.
const std::vector<GeneratorInfo>& generators();

/// 255, 32767, 65535 and 1.
double full_scale(VoxelType type);

bool is_generator(const std::string& text);  // starts with "generator:"

/// "generator:NAME:SIZE", "generator:NAME:XxYxZ", each optionally with ":uint8|int16|uint16|float32" (default
/// uint8). Throws brace::Error (exit code 2) that says what is accepted.
GeneratorSpec parse_generator(const std::string& text);

/// "generator:NAME:XxYxZ:TYPE".
std::string to_string(const GeneratorSpec& spec);

using VolumeFormula = std::function<double(double x, double y, double z)>;

/// The continuous formula. Throws on an unknown name.
VolumeFormula generator_formula(const std::string& name);

/// Samples made slab by slab, as asked for; never the whole volume.
std::unique_ptr<VolumeSource> open_generator(const GeneratorSpec& spec);

}  // namespace brace
