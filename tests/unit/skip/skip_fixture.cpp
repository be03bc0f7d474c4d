#include "skip/skip_fixture.hpp"

#include <cmath>
#include <cstring>

namespace brace {

namespace {

template <typename T>
void put(Volume& volume, std::size_t at, double value) {
  const T voxel = static_cast<T>(value);
  std::memcpy(volume.voxels.data() + at * sizeof(T), &voxel, sizeof(T));
}

void put_voxel(Volume& volume, std::size_t at, double value) {
  switch (volume.info.type) {
    case VoxelType::uint8:
      return put<std::uint8_t>(volume, at, value);
    case VoxelType::int16:
      return put<std::int16_t>(volume, at, value - 1000);
    case VoxelType::uint16:
      return put<std::uint16_t>(volume, at, value * 3);
    case VoxelType::float32:
      return put<float>(volume, at, value * 0.37 - 20);
  }
}

}  // namespace

std::filesystem::path source_folder() {
  return BRACE_SOURCE_DIR;
}

SkipKernels& SkipTest::kernels() {
  if (!kernels_) kernels_ = std::make_unique<SkipKernels>(device(), source_folder() / "runtime/skip/kernels");
  return *kernels_;
}

void SkipTest::TearDownTestSuite() {
  kernels_.reset();
  GpuTest::TearDownTestSuite();
}

oracle::BlockValues SkipTest::distances(const DistanceMaps& maps, int map, const BlockGrid& grid) {
  const DistanceMaps::Place place = maps.place(map);
  std::vector<std::uint8_t> bytes(grid.map_bytes());
  gpu::download_values(device(), *place.buffer, std::span<std::uint8_t>(bytes),
                       place.index * grid.map_bytes());
  oracle::BlockValues values;
  for (std::uint32_t row = 0; row < grid.rows(); ++row)
    for (std::uint32_t x = 0; x < grid.blocks[0]; ++x)
      values.push_back(bytes[row * grid.row_quads() * 16 + x]);
  return values;
}

oracle::BlockValues SkipTest::bits(const gpu::Buffer& planes, int plane, const BlockGrid& grid) {
  std::vector<std::uint32_t> words(grid.plane_words());
  gpu::download_values(device(), planes, std::span<std::uint32_t>(words),
                       static_cast<std::uint64_t>(plane) * grid.plane_bytes());
  oracle::BlockValues values;
  for (std::uint32_t row = 0; row < grid.rows(); ++row)
    for (std::uint32_t x = 0; x < grid.blocks[0]; ++x)
      values.push_back(static_cast<int>(words[row * grid.row_words() + x / 32] >> (x % 32) & 1u));
  return values;
}

int random_int(Random& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

Volume random_volume(Random& random, VoxelType type, int size_max) {
  Volume volume;
  for (int& dim : volume.info.dims)
    dim = random_int(random, 1, size_max);
  volume.info.type = type;
  if (random_int(random, 0, 2) == 0) volume.info.spacing = {1.0, 0.7, 1.9};
  volume.info.source = "random volume";
  volume.voxels.resize(volume.info.byte_count());
  const int kind = random_int(random, 0, 5);
  const int background = random_int(random, 0, 2) == 0 ? random_int(random, 0, 255) : 0;
  const int other = random_int(random, 0, 255);
  const auto count = static_cast<std::size_t>(volume.info.voxel_count());
  for (std::size_t at = 0; at < count; ++at) {
    int value = background;
    if (kind == 1) value = random_int(random, 0, 255);
    if (kind == 2 && random_int(random, 0, 30) == 0) value = random_int(random, 0, 255);
    if (kind == 3 && random_int(random, 0, 9) == 0) value = other;
    if (kind == 4) value = at > count / 2 ? other : background;
    if (kind == 5) value = std::min(255, background + random_int(random, 0, 3));
    put_voxel(volume, at, value);
  }
  return volume;
}

TransferTable table_of(ValueRange range, const std::vector<bool>& visible) {
  TransferTable table;
  table.range = range;
  for (std::size_t i = 0; i < visible.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(visible.size());
    table.entries.push_back({t, 1 - t, 0.5, visible[i] ? 0.05 + 0.5 * t : 0.0});
  }
  return table;
}

TransferTable random_table(Random& random, const VoxelStatistics& statistics) {
  const TableLayout layout = table_layout(statistics.type, statistics.range);
  std::vector<bool> visible(static_cast<std::size_t>(layout.entries), random_int(random, 0, 9) == 0);
  const int runs = random_int(random, 0, 3);
  for (int r = 0; r < runs; ++r) {
    const int begin = random_int(random, 0, layout.entries - 1);
    const int end =
        std::min(layout.entries, begin + random_int(random, 1, random_int(random, 1, layout.entries / 4)));
    for (int i = begin; i < end; ++i)
      visible[static_cast<std::size_t>(i)] = true;
  }
  return table_of(layout.range, visible);
}

TransferTable paper_table(int number, ValueRange range) {
  std::vector<bool> visible(256);
  for (std::size_t i = 0; i < 256; ++i) {
    if (number == 1) visible[i] = i > 0;
    if (number == 2) visible[i] = true;
    if (number == 3) visible[i] = i >= 128;
    if (number == 4) visible[i] = (i / 64) % 2 == 1;
    if (number == 5) visible[i] = i >= 40 && i < 230;
    if (number == 6) visible[i] = i >= 5 && i < 140;
  }
  return table_of(range, visible);
}

}  // namespace brace
