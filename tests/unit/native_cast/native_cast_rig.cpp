#include "tests/unit/native_cast/native_cast_rig.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "runtime/host/plugin_library.hpp"

namespace brace {

namespace {

template <typename Voxel>
void fill(TestVolume& volume, Random& random, double low, double high, double empty) {
  std::uniform_real_distribution<double> value(low, high), chance(0.0, 1.0);
  const std::size_t count = std::size_t{volume.dims[0]} * volume.dims[1] * volume.dims[2];
  std::vector<Voxel> voxels(count);
  for (Voxel& voxel : voxels)
    voxel = static_cast<Voxel>(chance(random) < empty ? low : value(random));
  volume.bytes.resize(count * sizeof(Voxel));
  std::memcpy(volume.bytes.data(), voxels.data(), volume.bytes.size());
  volume.values.assign(voxels.begin(), voxels.end());
}

brace_result read_slices(const brace_volume* volume, std::uint32_t z, std::uint32_t count, void* voxels,
                         std::uint64_t bytes) {
  const auto& test = *static_cast<const TestVolume*>(volume->host_context);
  const std::size_t slice = test.bytes.size() / test.dims[2];
  if (bytes != slice * count) return BRACE_INVALID_ARGUMENT;
  std::memcpy(voxels, test.bytes.data() + slice * z, bytes);
  return BRACE_OK;
}

/// Appends a ray of a length from an eye, with its direction in metric axes of length 1.
void add_ray(TestRays& rays, const TestVolume& volume, const std::array<double, 3>& eye,
             const std::array<double, 3>& direction) {
  double enter = 0.0, leave = 1e9;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (eye[axis] < 0.0 || eye[axis] > volume.dims[axis]) leave = 0.0;
      continue;
    }
    const double low = -eye[axis] / direction[axis], high = (volume.dims[axis] - eye[axis]) / direction[axis];
    enter = std::max(enter, std::min(low, high));
    leave = std::min(leave, std::max(low, high));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double entry = std::clamp(eye[axis] + enter * direction[axis], 0.0, 1.0 * volume.dims[axis]);
    rays.entries.push_back(static_cast<float>(entry));
    rays.directions.push_back(static_cast<float>(direction[axis]));
  }
  rays.entries.push_back(static_cast<float>(std::max(0.0, leave - enter)));
  rays.directions.push_back(0.0f);
}

std::uint32_t& word(TestMap& map, const std::uint32_t (&pitch)[4], int x, int y, int z) {
  return map.words[static_cast<std::size_t>(z) * pitch[1] + static_cast<std::size_t>(y) * pitch[0] +
                   static_cast<std::size_t>(x)];
}

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

}  // namespace

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

TestVolume random_volume(std::array<std::uint32_t, 3> dims, brace_voxel_type type, Random& random,
                         double empty) {
  TestVolume volume;
  volume.dims = dims;
  volume.type = type;
  const auto [low, high] = range_of(type);
  if (type == BRACE_VOXEL_UINT8) fill<std::uint8_t>(volume, random, low, high, empty);
  if (type == BRACE_VOXEL_INT16) fill<std::int16_t>(volume, random, low, high, empty);
  if (type == BRACE_VOXEL_UINT16) fill<std::uint16_t>(volume, random, low, high, empty);
  if (type == BRACE_VOXEL_FLOAT32) fill<float>(volume, random, low, high, empty);
  return volume;
}

TestTransfer::TestTransfer(Range range, double step)
    : step_units(step),
      table{sizeof table, 256, range.low, range.high, nullptr},
      visible_above(range.low + 0.2 * (range.high - range.low)) {
  for (int i = 0; i < 256; ++i) {
    const double u = i / 255.0;
    const double kappa = std::max(0.0, u - 0.2) / step_units;
    for (const double value : {u, 1.0 - u, 0.5, kappa})
      entries.push_back(value);
    for (const double value : {u, 1.0 - u, 0.5, kappa * step_units * std::numbers::log2e})
      baked.push_back(static_cast<float>(value));
  }
  baked.resize(4 * 4096);
  table.entries_rgbk = entries.data();
}

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

TestRays camera_rays(std::uint32_t across, std::uint32_t down, const TestVolume& volume, double away,
                     double spacing, Random& random) {
  TestRays rays{across, down, {}, {}};
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::array<double, 3> forward{unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5}, eye{};
  if (unit(random) < 0.4) forward = {0.0, unit(random) < 0.5 ? -1.0 : 1.0, 0.0};
  std::rotate(forward.begin(), forward.begin() + static_cast<std::ptrdiff_t>(random() % 3), forward.end());
  const auto normalise = [](std::array<double, 3>& v) {
    const double length = std::hypot(v[0], v[1], v[2]);
    for (double& c : v)
      c /= length;
  };
  normalise(forward);
  for (std::size_t axis = 0; axis < 3; ++axis)
    eye[axis] = 0.5 * volume.dims[axis] - away * forward[axis];
  const std::array<double, 3> right{forward[1] + forward[2], -forward[0], -forward[0]};
  const std::array<double, 3> lower{forward[1] * right[2] - forward[2] * right[1],
                                    forward[2] * right[0] - forward[0] * right[2],
                                    forward[0] * right[1] - forward[1] * right[0]};
  for (std::uint32_t y = 0; y < down; ++y) {
    for (std::uint32_t x = 0; x < across; ++x) {
      std::array<double, 3> direction = forward;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        direction[axis] += spacing / away * (x - 0.5 * across) * right[axis];
        direction[axis] += spacing / away * (y - 0.5 * down) * lower[axis];
      }
      normalise(direction);
      add_ray(rays, volume, eye, direction);
    }
  }
  return rays;
}

Blocks::Blocks(const TestVolume& volume, double visible_above) {
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
          visible = visible || at(x * block_edge + i, y * block_edge + j, z * block_edge + k) > visible_above;
    occupied_.push_back(visible);
  });
}

template <typename Call>
void Blocks::for_each(const Call& call) const {
  for (int z = 0; z < count_[2]; ++z)
    for (int y = 0; y < count_[1]; ++y)
      for (int x = 0; x < count_[0]; ++x)
        call(x, y, z);
}
bool Blocks::occupied(int x, int y, int z) const {
  return occupied_[static_cast<std::size_t>((z * count_[1] + y) * count_[0] + x)];
}

TestMap Blocks::map(brace_skip_map kind) const {
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

int Blocks::distance(int x, int y, int z) const {
  int least = 255;
  for_each([&](int i, int j, int k) {
    if (occupied(i, j, k))
      least = std::min(least, std::max({std::abs(i - x), std::abs(j - y), std::abs(k - z)}));
  });
  return least;
}
void Blocks::pitch(std::uint32_t (&to)[4], int per_word) const {
  to[0] = static_cast<std::uint32_t>((count_[0] + per_word - 1) / per_word);
  to[1] = to[0] * static_cast<std::uint32_t>(count_[1]);
}
void Blocks::distances(TestMap& map) const {
  pitch(map.params.map, 4);
  map.words.resize(std::size_t{map.params.map[1]} * map.params.blocks[2]);
  for_each([&](int x, int y, int z) {
    word(map, map.params.map, x >> 2, y, z) |= static_cast<std::uint32_t>(distance(x, y, z)) << (x & 3) * 8;
  });
}
void Blocks::bits(TestMap& map) const {
  pitch(map.params.plane, 32);
  map.words.resize(std::size_t{map.params.plane[1]} * map.params.blocks[2]);
  for_each([&](int x, int y, int z) {
    if (occupied(x, y, z)) word(map, map.params.plane, x >> 5, y, z) |= 1u << (x & 31);
  });
}
void Blocks::octree(TestMap& map) const {
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

Caster::Caster(const char* file, const char* name, const TestVolume& volume, const TestTransfer& transfer,
               int instructions, brace_shading shading)
    : test_(volume), transfer_(transfer) {
  StageRegistry registry;
  add_plugins(registry, {.given = {file}, .ambient = {}, .installed = {}});
  PipelineStage stage{registry.find("cast", name, "test"), {}};
  for (const StageParameter& parameter : stage.stage.parameters) {
    double value = parameter.default_value;
    if (parameter.name == "instructions" && instructions >= 0) value = instructions;
    if (parameter.name == "step_voxels") value = transfer.step_units;
    stage.values.push_back(value);
  }
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
  activation_.step_units = transfer.step_units;
  activation_.shading = shading;
  activation_.shading_samples = 18;
  activation_.shading_step_units = 0.8;
  activation_.shading_light[1] = 1.0;
  stage_.activate(activation_);
}

Picture Caster::cast(const TestRays& rays, const TestMap& map) {
  return cast(rays, map, {0, 0, rays.across, rays.down});
}

Picture Caster::cast(const TestRays& rays, const TestMap& map, const brace_area& area) {
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

}  // namespace brace
