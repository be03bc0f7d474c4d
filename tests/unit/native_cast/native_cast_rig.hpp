// What the tests of cast/native cast: volumes, rays and skip maps by definition, and the stage itself through
// its C interface, without a device.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "plugins/abi/glsl/brace/eye_params.h"
#include "plugins/abi/glsl/brace/skip_params.h"
#include "runtime/host/native_stage.hpp"

namespace brace {

using Random = std::mt19937;
constexpr int block_edge = 4;

struct TestVolume {
  std::array<std::uint32_t, 3> dims{1, 1, 1};
  brace_voxel_type type = BRACE_VOXEL_UINT8;
  std::array<double, 3> spacing{1, 1, 1};
  std::vector<unsigned char> bytes;
  std::vector<double> values;
};

struct Range {
  double low, high;
};

Range range_of(brace_voxel_type type);

/// `empty`: the share of voxels with the lowest value.
TestVolume random_volume(std::array<std::uint32_t, 3> dims, brace_voxel_type type, Random& random,
                         double empty = 0.9);

/// Transparent up to a fifth of the range, then a ramp.
struct TestTransfer {
  explicit TestTransfer(Range range, double step = 0.5);

  double step_units;  // of the casters, too
  std::vector<double> entries;
  std::vector<float> baked;  // as TransferOnDevice makes it
  brace_transfer_table table;
  double visible_above;
};

struct TestRays {
  std::uint32_t across = 1, down = 1;
  std::vector<float> entries, directions;
};

/// Rays through the volume from anywhere, some along axes, some inside, some that miss.
TestRays random_rays(std::uint32_t across, std::uint32_t down, const TestVolume& volume, Random& random);

/// Rays of a camera that looks at the volume's middle, at times along an axis, `spacing` voxels apart there;
/// some may miss.
TestRays camera_rays(std::uint32_t across, std::uint32_t down, const TestVolume& volume, double away,
                     double spacing, Random& random);

/// A skip map by definition: blocks with what lies a voxel around them.
struct TestMap {
  brace_skip_map kind = BRACE_SKIP_MAP_NONE;
  BraceSkipParams params{};
  std::vector<std::uint32_t> words;
};

/// Which blocks of a volume may show something, and maps that say so.
class Blocks {
 public:
  Blocks(const TestVolume& volume, double visible_above);

  TestMap map(brace_skip_map kind) const;

 private:
  template <typename Call>
  void for_each(const Call& call) const;
  bool occupied(int x, int y, int z) const;
  int distance(int x, int y, int z) const;
  void pitch(std::uint32_t (&to)[4], int per_word) const;
  void distances(TestMap& map) const;
  void bits(TestMap& map) const;
  void octree(TestMap& map) const;

  std::array<int, 3> count_{};
  std::vector<bool> occupied_;
};

struct Picture {
  std::vector<float> colours, depths_m;
  brace_work_counts counted{};
};

/// A cast stage of a library, activated.
class Caster {
 public:
  Caster(const char* file, const char* name, const TestVolume& volume, const TestTransfer& transfer,
         int instructions = -1, brace_shading shading = BRACE_SHADING_NONE);

  Picture cast(const TestRays& rays, const TestMap& map = {});
  Picture cast(const TestRays& rays, const TestMap& map, const brace_area& area);

 private:
  const TestVolume& test_;
  const TestTransfer& transfer_;
  NativeStage stage_;
  brace_volume volume_{};
  brace_activation activation_{};
};

/// Those that this processor has, by the choices of the parameter: "auto" first, plain C++ last. The choice
/// of the caster made last holds for all of them.
std::vector<std::string> instruction_names();

void expect_near(const Picture& picture, const Picture& oracle);

}  // namespace brace
