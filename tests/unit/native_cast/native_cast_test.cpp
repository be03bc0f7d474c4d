// cast/native through its C interface, without a device: against the double-precision cast/reference, and
// with skip maps against itself, on every instruction set that this processor has.
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "plugins/abi/glsl/brace/eye_params.h"
#include "plugins/abi/glsl/brace/skip_params.h"
#include "runtime/host/native_stage.hpp"
#include "runtime/host/plugin_library.hpp"

namespace brace {
namespace {

using Random = std::mt19937;
constexpr double step_units = 0.5;
constexpr int block_edge = 4;

struct TestVolume {
  std::array<std::uint32_t, 3> dims{1, 1, 1};
  brace_voxel_type type = BRACE_VOXEL_UINT8;
  std::array<double, 3> spacing{1, 1, 1};
  std::vector<unsigned char> bytes;
  std::vector<double> values;
};

template <typename Voxel>
void fill(TestVolume& volume, Random& random, double low, double high) {
  // Mostly the lowest value: something to skip.
  std::uniform_real_distribution<double> value(low, high), chance(0.0, 1.0);
  const std::size_t count = std::size_t{volume.dims[0]} * volume.dims[1] * volume.dims[2];
  std::vector<Voxel> voxels(count);
  for (Voxel& voxel : voxels)
    voxel = static_cast<Voxel>(chance(random) < 0.9 ? low : value(random));
  volume.bytes.resize(count * sizeof(Voxel));
  std::memcpy(volume.bytes.data(), voxels.data(), volume.bytes.size());
  volume.values.assign(voxels.begin(), voxels.end());
}

struct Range {
  double low, high;
};

Range range_of(brace_voxel_type type) {
  switch (type) {
    case BRACE_VOXEL_UINT8:
      return {0, 255};
    case BRACE_VOXEL_INT16:
      return {-20000, 20000};
    case BRACE_VOXEL_UINT16:
      return {0, 60000};
    case BRACE_VOXEL_FLOAT32:
      return {-1, 1};
  }
  return {0, 1};
}

TestVolume random_volume(std::array<std::uint32_t, 3> dims, brace_voxel_type type, Random& random) {
  TestVolume volume;
  volume.dims = dims;
  volume.type = type;
  const auto [low, high] = range_of(type);
  if (type == BRACE_VOXEL_UINT8) fill<std::uint8_t>(volume, random, low, high);
  if (type == BRACE_VOXEL_INT16) fill<std::int16_t>(volume, random, low, high);
  if (type == BRACE_VOXEL_UINT16) fill<std::uint16_t>(volume, random, low, high);
  if (type == BRACE_VOXEL_FLOAT32) fill<float>(volume, random, low, high);
  return volume;
}

/// Transparent up to a fifth of the range, then a ramp.
struct TestTransfer {
  explicit TestTransfer(Range range)
      : table{sizeof table, 256, range.low, range.high, nullptr},
        visible_above(range.low + 0.2 * (range.high - range.low)) {
    for (int i = 0; i < 256; ++i) {
      const double u = i / 255.0;
      const double kappa = std::max(0.0, u - 0.2) * 2.0;
      for (const double value : {u, 1.0 - u, 0.5, kappa})
        entries.push_back(value);
      for (const double value : {u, 1.0 - u, 0.5, kappa * step_units * std::numbers::log2e})
        baked.push_back(static_cast<float>(value));
    }
    baked.resize(4 * 4096);
    table.entries_rgbk = entries.data();
  }
  std::vector<double> entries;
  std::vector<float> baked;  // as TransferOnDevice makes it
  brace_transfer_table table;
  double visible_above;
};

brace_result read_slices(const brace_volume* volume, std::uint32_t z, std::uint32_t count, void* voxels,
                         std::uint64_t bytes) {
  const auto& test = *static_cast<const TestVolume*>(volume->host_context);
  const std::size_t slice = test.bytes.size() / test.dims[2];
  if (bytes != slice * count) return BRACE_INVALID_ARGUMENT;
  std::memcpy(voxels, test.bytes.data() + slice * z, bytes);
  return BRACE_OK;
}

struct TestRays {
  std::uint32_t across = 1, down = 1;
  std::vector<float> entries, directions;
};

/// Rays through the volume from anywhere, some along axes, some inside, some that miss.
TestRays random_rays(std::uint32_t across, std::uint32_t down, const TestVolume& volume, Random& random) {
  TestRays rays{across, down, {}, {}};
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (std::uint32_t ray = 0; ray < across * down; ++ray) {
    const int kind = static_cast<int>(ray % 5);
    double at[3], direction[3], length = 0, back = 1e9, forth = 1e9;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] = unit(random) * volume.dims[axis];
      direction[axis] = unit(random) - 0.5;
      if (kind == 1 && axis != ray % 3) direction[axis] = 0.0;
      if (kind == 2) at[axis] = std::floor(at[axis]);
      length += direction[axis] * direction[axis];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      direction[axis] /= std::sqrt(length);
      if (direction[axis] == 0.0) continue;
      const double low = -at[axis] / direction[axis], high = (volume.dims[axis] - at[axis]) / direction[axis];
      back = std::min(back, -std::min(low, high));
      forth = std::min(forth, std::max(low, high));
    }
    if (kind == 3) back = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rays.entries.push_back(
          static_cast<float>(std::clamp(at[axis] - back * direction[axis], 0.0, 1.0 * volume.dims[axis])));
      rays.directions.push_back(static_cast<float>(direction[axis]));
    }
    rays.entries.push_back(kind == 4 && ray % 2 == 0 ? 0.0f : static_cast<float>(back + forth));
    rays.directions.push_back(0.0f);
  }
  return rays;
}

/// A skip map by definition: blocks with what lies a voxel around them.
struct TestMap {
  brace_skip_map kind = BRACE_SKIP_MAP_NONE;
  BraceSkipParams params{};
  std::vector<std::uint32_t> words;
};

class Blocks {
 public:
  Blocks(const TestVolume& volume, double visible_above) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      count_[axis] = static_cast<int>(volume.dims[axis] + block_edge - 1) / block_edge;
    const auto at = [&](int x, int y, int z) {
      const auto inside = [](int i, std::uint32_t n) {
        return static_cast<std::size_t>(std::clamp(i, 0, static_cast<int>(n) - 1));
      };
      return volume
          .values[(inside(z, volume.dims[2]) * volume.dims[1] + inside(y, volume.dims[1])) * volume.dims[0] +
                  inside(x, volume.dims[0])];
    };
    for_each([&](int x, int y, int z) {
      bool visible = false;
      for (int k = -1; k <= block_edge; ++k)
        for (int j = -1; j <= block_edge; ++j)
          for (int i = -1; i <= block_edge; ++i)
            visible =
                visible || at(x * block_edge + i, y * block_edge + j, z * block_edge + k) > visible_above;
      occupied_.push_back(visible);
    });
  }

  template <typename Call>
  void for_each(const Call& call) const {
    for (int z = 0; z < count_[2]; ++z)
      for (int y = 0; y < count_[1]; ++y)
        for (int x = 0; x < count_[0]; ++x)
          call(x, y, z);
  }
  bool occupied(int x, int y, int z) const {
    return occupied_[static_cast<std::size_t>((z * count_[1] + y) * count_[0] + x)];
  }

  TestMap map(brace_skip_map kind) const {
    TestMap map;
    map.kind = kind;
    for (std::size_t axis = 0; axis < 3; ++axis)
      map.params.blocks[axis] = static_cast<std::uint32_t>(count_[axis]);
    map.params.edge[0] = block_edge;
    map.params.edge[1] = 1.0f / block_edge;
    if (kind == BRACE_SKIP_MAP_DISTANCES) distances(map);
    if (kind == BRACE_SKIP_MAP_BITS) bits(map);
    if (kind == BRACE_SKIP_MAP_OCTREE) octree(map);
    return map;
  }

 private:
  int distance(int x, int y, int z) const {
    int least = 255;
    for_each([&](int i, int j, int k) {
      if (occupied(i, j, k))
        least = std::min(least, std::max({std::abs(i - x), std::abs(j - y), std::abs(k - z)}));
    });
    return least;
  }
  void pitch(std::uint32_t (&to)[4], int per_word) const {
    to[0] = static_cast<std::uint32_t>((count_[0] + per_word - 1) / per_word);
    to[1] = to[0] * static_cast<std::uint32_t>(count_[1]);
  }
  static std::uint32_t& word(TestMap& map, const std::uint32_t (&pitch)[4], int x, int y, int z) {
    return map.words[static_cast<std::size_t>(z) * pitch[1] + static_cast<std::size_t>(y) * pitch[0] +
                     static_cast<std::size_t>(x)];
  }
  void distances(TestMap& map) const {
    pitch(map.params.map, 4);
    map.words.resize(std::size_t{map.params.map[1]} * map.params.blocks[2]);
    for_each([&](int x, int y, int z) {
      word(map, map.params.map, x >> 2, y, z) |= static_cast<std::uint32_t>(distance(x, y, z)) << (x & 3) * 8;
    });
  }
  void bits(TestMap& map) const {
    pitch(map.params.plane, 32);
    map.words.resize(std::size_t{map.params.plane[1]} * map.params.blocks[2]);
    for_each([&](int x, int y, int z) {
      if (occupied(x, y, z)) word(map, map.params.plane, x >> 5, y, z) |= 1u << (x & 31);
    });
  }
  void octree(TestMap& map) const {
    map.params.octree[1] = 1;
    map.params.visible[0][0] = 2;  // the second partition is visible
    std::array<int, 3> size = count_;
    for (std::uint32_t level = 0;; ++level) {
      auto& at = map.params.level[level];
      for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis] = static_cast<std::uint32_t>(size[axis]);
      at[3] = static_cast<std::uint32_t>(map.words.size());
      map.words.resize(map.words.size() + static_cast<std::size_t>(size[0] * size[1] * size[2]), 1u);
      for_each([&](int x, int y, int z) {
        const int node = ((z >> level) * size[1] + (y >> level)) * size[0] + (x >> level);
        if (occupied(x, y, z)) map.words[at[3] + static_cast<std::size_t>(node)] |= 2u;
      });
      map.params.octree[0] = level + 1;
      if (size == std::array<int, 3>{1, 1, 1}) return;
      for (int& edge : size)
        edge = (edge + 1) / 2;
    }
  }

  std::array<int, 3> count_{};
  std::vector<bool> occupied_;
};

struct Picture {
  std::vector<float> colours, depths_m;
  brace_work_counts counted{};
};

BraceEyeParams eye_params(const TestVolume& volume, const TestTransfer& transfer) {
  BraceEyeParams params{};
  params.eye[0] = -3.0f;
  params.eye[3] = 0.01f;
  const double scale = 255.0 / (transfer.table.maximum - transfer.table.minimum);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    params.voxels_per_unit[axis] = 1.0f;
    params.volume_dims[axis] = static_cast<float>(volume.dims[axis]);
  }
  params.transfer[0] = static_cast<float>(scale);
  params.transfer[1] = static_cast<float>(-transfer.table.minimum * scale);
  params.transfer[2] = 255.0f;
  params.transfer[3] = 51.0f;  // entry 51 is the last without absorption
  return params;
}

class Caster {
 public:
  Caster(const char* file, const char* name, const TestVolume& volume, const TestTransfer& transfer,
         int instructions = -1, brace_shading shading = BRACE_SHADING_NONE)
      : test_(volume), transfer_(transfer) {
    StageRegistry registry;
    add_plugins(registry, {.given = {file}, .ambient = {}, .installed = {}});
    PipelineStage stage{registry.find("cast", name, "test"), {}};
    for (const StageParameter& parameter : stage.stage.parameters)
      stage.values.push_back(parameter.name == "instructions" && instructions >= 0 ? instructions
                                                                                   : parameter.default_value);
    stage_ = NativeStage(stage);
    volume_.struct_size = sizeof volume_;
    std::copy(volume.dims.begin(), volume.dims.end(), volume_.dims);
    volume_.type = volume.type;
    std::copy(volume.spacing.begin(), volume.spacing.end(), volume_.spacing);
    volume_.metres_per_unit = 0.01;
    volume_.value_scale = 1.0;
    volume_.read_slices = read_slices;
    volume_.host_context = const_cast<TestVolume*>(&volume);
    activation_.struct_size = sizeof activation_;
    activation_.volume = &volume_;
    activation_.transfer = &transfer.table;
    activation_.step_units = step_units;
    activation_.shading = shading;
    activation_.shading_samples = 18;
    activation_.shading_step_units = 0.8;
    activation_.shading_light[1] = 1.0;
    stage_.activate(activation_);
  }

  Picture cast(const TestRays& rays, const TestMap& map = {}) {
    return cast(rays, map, {0, 0, rays.across, rays.down});
  }

  Picture cast(const TestRays& rays, const TestMap& map, const brace_area& area) {
    Picture picture;
    picture.colours.assign(rays.entries.size(), -7.0f);
    picture.depths_m.assign(rays.entries.size() / 4, -7.0f);
    BraceEyeParams params = eye_params(test_, transfer_);
    brace_cast_frame frame{};
    frame.struct_size = sizeof frame;
    frame.rays_across = rays.across;
    frame.rays_down = rays.down;
    frame.area = area;
    const auto range = [](const void* data, std::size_t bytes) {
      return brace_buffer_range{nullptr, 0, bytes, const_cast<void*>(data)};
    };
    frame.params = range(&params, sizeof params);
    frame.ray_entries = range(rays.entries.data(), rays.entries.size() * 4);
    frame.ray_directions = range(rays.directions.data(), rays.directions.size() * 4);
    frame.result_colours = range(picture.colours.data(), picture.colours.size() * 4);
    frame.result_depths_m = range(picture.depths_m.data(), picture.depths_m.size() * 4);
    frame.transfer = range(transfer_.baked.data(), transfer_.baked.size() * 4);
    frame.skip_map = map.kind;
    if (map.kind != BRACE_SKIP_MAP_NONE) {
      frame.skip_words = range(map.words.data(), map.words.size() * 4);
      frame.skip_params = range(&map.params, sizeof map.params);
    }
    frame.counted = &picture.counted;
    stage_.cast(frame);
    return picture;
  }

 private:
  const TestVolume& test_;
  const TestTransfer& transfer_;
  NativeStage stage_;
  brace_volume volume_{};
  brace_activation activation_{};
};

/// Those that this processor has, by the choices of the parameter: "auto" first, plain C++ last.
std::vector<std::string> instruction_names() {
  StageRegistry registry;
  add_plugins(registry, {.given = {NATIVE_CAST}, .ambient = {}, .installed = {}});
  const StageInfo& stage = registry.find("cast", "native", "test");
  return stage.parameters.back().choices;
}

void expect_near(const Picture& picture, const Picture& oracle) {
  double worst = 0;
  for (std::size_t i = 0; i < oracle.colours.size(); ++i)
    worst = std::max(worst, std::abs(double{picture.colours[i]} - double{oracle.colours[i]}));
  EXPECT_LE(worst, 1e-4);
  for (std::size_t i = 0; i < oracle.depths_m.size(); ++i) {
    if (std::isinf(oracle.depths_m[i]) || std::isinf(picture.depths_m[i])) continue;
    EXPECT_NEAR(picture.depths_m[i], oracle.depths_m[i], 1e-2)
        << i;  // one step, where a sample is on the edge
  }
}

struct Case {
  std::array<std::uint32_t, 3> dims;
  std::uint32_t across, down;
};
constexpr std::array<Case, 5> cases = {
    {{{1, 1, 1}, 1, 1}, {{9, 5, 3}, 7, 5}, {{17, 16, 21}, 33, 18}, {{1, 30, 2}, 4, 4}, {{33, 1, 1}, 2, 9}}};

TEST(NativeCast, AgreesWithTheReferenceOnEveryInstructionSet) {
  Random random(7);
  for (const brace_voxel_type type :
       {BRACE_VOXEL_UINT8, BRACE_VOXEL_INT16, BRACE_VOXEL_UINT16, BRACE_VOXEL_FLOAT32}) {
    const TestTransfer transfer(range_of(type));
    for (const Case& one : cases) {
      const TestVolume volume = random_volume(one.dims, type, random);
      const TestRays rays = random_rays(one.across, one.down, volume, random);
      Caster reference(REFERENCE_CAST, "reference", volume, transfer);
      const Picture oracle = reference.cast(rays);
      const std::vector<std::string> names = instruction_names();
      ASSERT_EQ(names.back(), "scalar");
      for (std::size_t set = 1; set < names.size(); ++set) {
        SCOPED_TRACE(fmt::format("{} {} x {} x {}", names[set], one.dims[0], one.dims[1], one.dims[2]));
        Caster native(NATIVE_CAST, "native", volume, transfer, static_cast<int>(set));
        const Picture picture = native.cast(rays);
        expect_near(picture, oracle);
        EXPECT_LE(picture.counted.rays, std::uint64_t{rays.across} * rays.down);
      }
    }
  }
}

TEST(NativeCast, SkippingChangesNoBit) {
  Random random(11);
  std::uint64_t skipped = 0;
  for (int round = 0; round < 40; ++round) {
    const auto type = static_cast<brace_voxel_type>(round % 4);
    const TestTransfer transfer(range_of(type));
    const Case& one = cases[static_cast<std::size_t>(round) % cases.size()];
    const TestVolume volume = random_volume(one.dims, type, random);
    const TestRays rays = random_rays(one.across, one.down, volume, random);
    const Blocks blocks(volume, transfer.visible_above);
    for (std::size_t set = 1; set < instruction_names().size(); ++set) {
      Caster native(NATIVE_CAST, "native", volume, transfer, static_cast<int>(set));
      const Picture plain = native.cast(rays);
      for (const brace_skip_map kind :
           {BRACE_SKIP_MAP_DISTANCES, BRACE_SKIP_MAP_BITS, BRACE_SKIP_MAP_OCTREE}) {
        const Picture leaping = native.cast(rays, blocks.map(kind));
        EXPECT_EQ(leaping.colours, plain.colours) << round << ' ' << kind;
        EXPECT_EQ(leaping.depths_m, plain.depths_m) << round << ' ' << kind;
        EXPECT_LE(leaping.counted.samples, plain.counted.samples);
        skipped += plain.counted.samples - leaping.counted.samples;
      }
    }
  }
  EXPECT_GT(skipped, 1000u);
}

TEST(NativeCast, WorksOnTheAreaOnly) {
  Random random(3);
  const TestTransfer transfer({0, 255});
  const TestVolume volume = random_volume({12, 12, 12}, BRACE_VOXEL_UINT8, random);
  const TestRays rays = random_rays(11, 9, volume, random);
  Caster native(NATIVE_CAST, "native", volume, transfer);
  const Picture whole = native.cast(rays), part = native.cast(rays, {}, {3, 2, 5, 4});
  for (std::uint32_t y = 0; y < 9; ++y) {
    for (std::uint32_t x = 0; x < 11; ++x) {
      const bool inside = x >= 3 && x < 8 && y >= 2 && y < 6;
      const std::size_t ray = y * 11 + x;
      EXPECT_EQ(part.depths_m[ray], inside ? whole.depths_m[ray] : -7.0f) << x << ' ' << y;
    }
  }
}

TEST(NativeCast, NotANumberIsEmptyAndResultsKeepTheContract) {
  Random random(5);
  const TestTransfer transfer({-1, 1});
  TestVolume volume = random_volume({8, 8, 8}, BRACE_VOXEL_FLOAT32, random);
  std::vector<float> voxels(512, std::numeric_limits<float>::quiet_NaN());
  voxels[100] = std::numeric_limits<float>::infinity();
  voxels[200] = -std::numeric_limits<float>::infinity();
  std::memcpy(volume.bytes.data(), voxels.data(), volume.bytes.size());
  const TestRays rays = random_rays(16, 16, volume, random);
  for (const brace_shading shading :
       {BRACE_SHADING_NONE, BRACE_SHADING_PHONG, BRACE_SHADING_SHADOW_AO, BRACE_SHADING_RANDOM_LIGHTS}) {
    Caster native(NATIVE_CAST, "native", volume, transfer, -1, shading);
    const Picture picture = native.cast(rays);
    for (std::size_t ray = 0; ray < picture.depths_m.size(); ++ray) {
      const float* colour = &picture.colours[4 * ray];
      for (int c = 0; c < 3; ++c)
        EXPECT_TRUE(colour[c] >= 0.0f && colour[c] <= colour[3] && colour[3] <= 1.0f) << ray;
    }
  }
}

TEST(NativeCast, EveryInstructionSetIsLitAlikeByAdditionalSamples) {
  Random random(13);
  const TestTransfer transfer({0, 255});
  const TestVolume volume = random_volume({17, 16, 21}, BRACE_VOXEL_UINT8, random);
  const TestRays rays = random_rays(16, 9, volume, random);
  const std::vector<std::string> names = instruction_names();
  for (const brace_shading shading : {BRACE_SHADING_SHADOW_AO, BRACE_SHADING_RANDOM_LIGHTS}) {
    Caster scalar(NATIVE_CAST, "native", volume, transfer, static_cast<int>(names.size()) - 1, shading);
    const Picture oracle = scalar.cast(rays);
    EXPECT_EQ(oracle.counted.shading_fetches % (shading == BRACE_SHADING_SHADOW_AO ? 38 : 18), 0u);
    EXPECT_GT(oracle.counted.shading_fetches, 0u);
    for (std::size_t set = 1; set + 1 < names.size(); ++set) {
      SCOPED_TRACE(names[set]);
      Caster native(NATIVE_CAST, "native", volume, transfer, static_cast<int>(set), shading);
      const Picture picture = native.cast(rays);
      expect_near(picture, oracle);
      EXPECT_EQ(picture.counted.shading_fetches, oracle.counted.shading_fetches);
    }
  }
}

TEST(NativeCast, ShadingFetchesSixPerVisibleSample) {
  Random random(9);
  const TestTransfer transfer({0, 255});
  const TestVolume volume = random_volume({16, 16, 16}, BRACE_VOXEL_UINT8, random);
  const TestRays rays = random_rays(16, 16, volume, random);
  Caster plain(NATIVE_CAST, "native", volume, transfer);
  Caster lit(NATIVE_CAST, "native", volume, transfer, -1, BRACE_SHADING_PHONG);
  const Picture unlit = plain.cast(rays), shaded = lit.cast(rays);
  EXPECT_EQ(unlit.counted.shading_fetches, 0u);
  EXPECT_GT(shaded.counted.shading_fetches, 0u);
  EXPECT_EQ(shaded.counted.shading_fetches % 6, 0u);
  EXPECT_EQ(shaded.counted.samples, unlit.counted.samples);
  EXPECT_EQ(shaded.depths_m, unlit.depths_m);
  EXPECT_NE(shaded.colours, unlit.colours);
}

}  // namespace
}  // namespace brace
