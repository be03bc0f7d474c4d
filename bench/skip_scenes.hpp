#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "runtime/volume/transfer_function.hpp"
#include "runtime/volume/volume.hpp"

namespace brace::bench {

/// A generated volume of the size and occupancy of one of the paper's data sets.
struct SkipScene {
  std::string name;        // "head", "insect", "snake"
  std::string stands_for;  // the paper's: "manix", "stag beetle", "kingsnake"
  std::array<int, 3> dims{};
};

/// The three of Table 1; `divisor` makes them smaller in every direction.
std::vector<SkipScene> skip_scenes(int divisor);

/// uint8, from a formula with hashed noise, slice by slice.
std::unique_ptr<VolumeSource> open_skip_scene(const SkipScene& scene);

/// TF1 … TF6 of the paper's Fig. 3 over [0, 255]: all but the smallest value, all, the upper half, the second
/// and fourth quarter, and two ramps as read off its pictures.
TransferTable skip_table(int number);

/// A number of 0 … 255 from a place, the same everywhere.
std::uint32_t noise(int x, int y, int z);

}  // namespace brace::bench
