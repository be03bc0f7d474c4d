#include "bench/skip_octants.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "bench/skip_scenes.hpp"

namespace brace::bench {

namespace {

constexpr int edge = 4;            // voxels of a block
constexpr int distance_max = 255;  // uint8
constexpr int rays = 4096;

/// Blocks of a scene: 1 where a table shows something of the block or of the voxels next to it.
struct Blocks {
  std::array<int, 3> dims{};
  std::vector<std::uint8_t> occupied;

  std::size_t at(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(dims[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(dims[0]) +
           static_cast<std::size_t>(x);
  }
  bool inside(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < dims[0] && y < dims[1] && z < dims[2];
  }
};

Blocks blocks_of(const SkipScene& scene, const TransferTable& table) {
  const std::unique_ptr<VolumeSource> source = open_skip_scene(scene);
  const std::array<int, 3> voxels = source->info().dims;
  Blocks blocks;
  for (std::size_t axis = 0; axis < 3; ++axis)
    blocks.dims[axis] = (voxels[axis] + edge - 1) / edge;
  blocks.occupied.resize(static_cast<std::size_t>(blocks.dims[0]) * static_cast<std::size_t>(blocks.dims[1]) *
                         static_cast<std::size_t>(blocks.dims[2]));
  std::array<bool, 256> visible{};
  for (std::size_t value = 0; value < visible.size(); ++value)
    visible[value] = table.entries[value * (table.entries.size() - 1) / 255][3] > 0.0f;
  std::vector<std::byte> slice(static_cast<std::size_t>(voxels[0]) * static_cast<std::size_t>(voxels[1]));
  for (int z = 0; z < voxels[2]; ++z) {
    source->read_slab(slice, z, 1);
    for (int y = 0; y < voxels[1]; ++y)
      for (int x = 0; x < voxels[0]; ++x) {
        const auto value =
            static_cast<std::size_t>(slice[static_cast<std::size_t>(y) * static_cast<std::size_t>(voxels[0]) +
                                           static_cast<std::size_t>(x)]);
        if (visible[value]) blocks.occupied[blocks.at(x / edge, y / edge, z / edge)] = 1;
      }
  }
  return blocks;
}

using Distances = std::vector<std::uint8_t>;
using Signs = std::array<int, 3>;

/// The edge of the largest cube of empty blocks that begins at each block and lies towards `signs`; beyond
/// the volume all is empty.
Distances octant_distances(const Blocks& blocks, const Signs& signs) {
  Distances d(blocks.occupied.size());
  const auto along = [&](std::size_t axis, int i) { return signs[axis] > 0 ? blocks.dims[axis] - 1 - i : i; };
  for (int k = 0; k < blocks.dims[2]; ++k)
    for (int j = 0; j < blocks.dims[1]; ++j)
      for (int i = 0; i < blocks.dims[0]; ++i) {
        const int x = along(0, i), y = along(1, j), z = along(2, k);
        if (blocks.occupied[blocks.at(x, y, z)]) continue;
        int least = distance_max - 1;
        for (int next = 1; next < 8; ++next) {
          const int nx = x + (next & 1) * signs[0], ny = y + (next >> 1 & 1) * signs[1],
                    nz = z + (next >> 2) * signs[2];
          if (blocks.inside(nx, ny, nz)) least = std::min(least, int{d[blocks.at(nx, ny, nz)]});
        }
        d[blocks.at(x, y, z)] = static_cast<std::uint8_t>(least + 1);
      }
  return d;
}

/// In all directions at once: the least of the octants.
Distances all_distances(const std::array<Distances, 8>& octants) {
  Distances d = octants[0];
  for (const Distances& octant : octants)
    std::transform(d.begin(), d.end(), octant.begin(), d.begin(),
                   [](auto a, auto b) { return std::min(a, b); });
  return d;
}

struct Ray {
  std::array<double, 3> origin{}, direction{};
};

/// From one random point of the box's surface to another, in blocks.
std::vector<Ray> random_rays(const Blocks& blocks) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto surface = [&] {
    std::array<double, 3> point{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      point[axis] = unit(random) * blocks.dims[axis];
    const auto axis = static_cast<std::size_t>(random() % 3);
    point[axis] = random() % 2 == 0 ? 0.0 : blocks.dims[axis];
    return point;
  };
  std::vector<Ray> all;
  while (all.size() < rays) {
    Ray ray{surface(), {}};
    const std::array<double, 3> to = surface();
    double squares = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ray.direction[axis] = to[axis] - ray.origin[axis];
      squares += ray.direction[axis] * ray.direction[axis];
    }
    if (squares < 1.0) continue;
    for (double& d : ray.direction)
      d = std::abs(d) < 1e-9 ? 1e-9 : d / std::sqrt(squares);
    all.push_back(ray);
  }
  return all;
}

/// Leaps of a ray over empty blocks: each goes to the face of the cube that is known to be empty. Occupied
/// blocks are crossed one by one and do not count.
std::uint64_t leaps_of(const Blocks& blocks, const Ray& ray, const Distances& distances) {
  std::array<double, 3> at = ray.origin;
  std::uint64_t leaps = 0;
  for (int guard = 0; guard < 100'000; ++guard) {
    std::array<int, 3> block{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      block[axis] = static_cast<int>(std::floor(at[axis] + 1e-7 * (ray.direction[axis] > 0 ? 1.0 : -1.0)));
    if (!blocks.inside(block[0], block[1], block[2])) return leaps;
    const int distance = distances[blocks.at(block[0], block[1], block[2])];
    leaps += distance > 0;
    const int reach = std::max(distance, 1) - 1;
    double t = 1e300;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double face = ray.direction[axis] > 0 ? block[axis] + 1 + reach : block[axis] - reach;
      t = std::min(t, (face - at[axis]) / ray.direction[axis]);
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis] += std::max(t, 0.0) * ray.direction[axis];
  }
  return leaps;
}

std::size_t octant_of(const Ray& ray) {
  return (ray.direction[0] > 0 ? 1u : 0u) | (ray.direction[1] > 0 ? 2u : 0u) |
         (ray.direction[2] > 0 ? 4u : 0u);
}

}  // namespace

std::vector<SkipOctantRow> count_octants(const SkipBenchOptions& options) {
  std::vector<SkipOctantRow> rows;
  for (const SkipScene& scene : skip_scenes(std::max(options.divisor, 2))) {
    if (std::find(options.scenes.begin(), options.scenes.end(), scene.name) == options.scenes.end()) continue;
    for (const int tf : {1, 3, 4}) {
      if (options.progress) options.progress("skip: octants, " + scene.name);
      const Blocks blocks = blocks_of(scene, skip_table(tf));
      std::array<Distances, 8> octants;
      for (std::size_t o = 0; o < 8; ++o)
        octants[o] = octant_distances(blocks, {o & 1 ? 1 : -1, o & 2 ? 1 : -1, o & 4 ? 1 : -1});
      const Distances all = all_distances(octants);
      SkipOctantRow row{scene.name, tf, 0, 0};
      for (const Ray& ray : random_rays(blocks)) {
        row.leaps_all += static_cast<double>(leaps_of(blocks, ray, all)) / rays;
        row.leaps_octant += static_cast<double>(leaps_of(blocks, ray, octants[octant_of(ray)])) / rays;
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace brace::bench
