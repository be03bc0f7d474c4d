#include "runtime/skip/structures.hpp"

#include "skip/skip_fixture.hpp"

namespace brace {
namespace {

using Skip = SkipTest;

constexpr VoxelType types[] = {VoxelType::uint8, VoxelType::int16, VoxelType::uint16, VoxelType::float32};
constexpr Occupancy occupancies[] = {Occupancy::cell, Occupancy::block, Occupancy::voxel};

void submit(gpu::CommandList& commands) {
  gpu::submit_and_wait(commands);
}

TEST_F(Skip, PartitionBitsEqualBruteForceForEveryTypeModeAndPath) {
  Random random(11);
  for (int repeat = 0; repeat < 48; ++repeat) {
    const VoxelType type = types[repeat % 4];
    const Occupancy occupancy = occupancies[repeat / 4 % 3];
    const Volume volume = random_volume(random, type, 9);
    MemorySource source(volume);
    const VoxelStatistics statistics = scan(volume);
    const VolumeOnDevice on_device(device(), source,
                                   repeat % 2 == 0 ? VolumePath::packed : VolumePath::sampler);
    const BlockGrid grid(volume.info, random_int(random, 2, 5));
    const int counts[] = {1, 7, 33, 64, 130, 256};
    const Partitioning partitioning = uniform_partitions(type, statistics.range, counts[repeat % 6]);
    const BitPlanes planes(kernels(), on_device, grid, partitioning, occupancy);
    ASSERT_EQ(planes.count(), partitioning.count());
    for (int p = 0; p < planes.count(); p += 1 + planes.count() / 8)
      ASSERT_EQ(bits(planes.buffer(), p, grid),
                oracle::in_partition(volume, grid, partitioning, p, occupancy))
          << "repeat " << repeat << " partition " << p;
  }
}

TEST_F(Skip, TransformEqualsBruteForceChebyshevDistances) {
  Random random(12);
  for (int repeat = 0; repeat < 30; ++repeat) {
    VolumeInfo info;
    const int size_max = repeat < 15 ? 8 : 70;
    info.dims = {random_int(random, 1, repeat == 0 ? 600 : size_max), random_int(random, 1, size_max / 2 + 1),
                 random_int(random, 1, 12)};
    if (repeat == 1) info.dims = {290, 2, 1};
    if (repeat == 2) info.dims = {3, 300, 2};
    if (repeat == 3) info.dims = {2, 3, 290};
    const BlockGrid grid(info, 2);
    std::vector<std::uint32_t> words(grid.plane_bytes() / 4 * 2, 0);
    std::vector<oracle::BlockValues> occupied(2, oracle::BlockValues(grid.count(), 0));
    for (std::size_t plane = 0; plane < 2; ++plane) {
      const int points = random_int(random, repeat < 4 ? 1 : 0, 5);
      for (int i = 0; i < points; ++i) {
        const auto x = static_cast<std::size_t>(random_int(random, 0, static_cast<int>(grid.blocks[0]) - 1));
        const auto row = static_cast<std::size_t>(random_int(random, 0, static_cast<int>(grid.rows()) - 1));
        occupied[plane][row * grid.blocks[0] + x] = 1;
        words[plane * grid.plane_bytes() / 4 + row * grid.row_words() + x / 32] |= 1u << (x % 32);
      }
    }
    const gpu::Buffer planes(device(), "planes", words.size() * 4, gpu::Memory::device);
    gpu::upload_values(device(), planes, std::span<const std::uint32_t>(words));
    const gpu::TexelBuffer texels(device(), planes, gpu::Format::r32_uint);
    DistanceMaps maps(device(), grid, "maps");
    maps.append(2);
    gpu::CommandList commands(device(), "test");
    record_transform(commands, kernels(), grid, texels, 0, maps, 0, 2);
    submit(commands);
    for (int plane = 0; plane < 2; ++plane)
      ASSERT_EQ(distances(maps, plane, grid),
                oracle::chebyshev(grid, occupied[static_cast<std::size_t>(plane)]))
          << "repeat " << repeat << " plane " << plane;
  }
}

TEST_F(Skip, MergedDistancesNeverExceedAndForAlignedPartitionsEqualTheExactOnes) {
  Random random(13);
  int aligned_seen = 0, looser_seen = 0;
  for (int repeat = 0; repeat < 60; ++repeat) {
    const Volume volume = random_volume(random, VoxelType::uint8, 14);
    MemorySource source(volume);
    const VoxelStatistics statistics = scan(volume);
    const VolumeOnDevice on_device(device(), source, VolumePath::packed);
    const BlockGrid grid(volume.info, 2);
    const int n = random_int(random, 1, 40);
    Partitioning partitioning = uniform_partitions(VoxelType::uint8, {0, 255}, n);
    // A table that is visible on whole partitions, and one that is not.
    std::vector<bool> visible(256);
    const bool aligned = repeat % 2 == 0;
    bool on = false;
    for (std::size_t i = 0; i < 256; ++i) {
      const bool border = std::find(partitioning.first_key.begin(), partitioning.first_key.end(), i) !=
                          partitioning.first_key.end();
      if (aligned ? border : random_int(random, 0, 30) == 0) on = random_int(random, 0, 2) == 0;
      visible[i] = on;
    }
    const TransferTable table = table_of({0, 255}, visible);
    const BitPlanes planes(kernels(), on_device, grid, partitioning, Occupancy::cell);
    DistanceMaps maps(device(), grid, "maps"), merged(device(), grid, "merged");
    maps.append(partitioning.count());
    merged.append(1);
    gpu::CommandList commands(device(), "test");
    record_transform(commands, kernels(), grid, planes.words(), 0, maps, 0, partitioning.count());
    std::vector<int> sources;
    const std::vector<bool> shown = Visibility(table).partitions(partitioning);
    for (int p = 0; p < partitioning.count(); ++p)
      if (shown[static_cast<std::size_t>(p)]) sources.push_back(p);
    record_minimum(commands, kernels(), grid, maps, sources, merged, 0);
    submit(commands);
    const auto approximate = distances(merged, 0, grid);
    const auto exact = oracle::chebyshev(grid, oracle::occupied(volume, grid, table, Occupancy::cell));
    for (std::size_t i = 0; i < exact.size(); ++i)
      ASSERT_LE(approximate[i], exact[i]) << "repeat " << repeat;
    if (aligned) {
      ASSERT_EQ(approximate, exact) << "repeat " << repeat;
    }
    aligned_seen += aligned;
    looser_seen += approximate != exact;
  }
  EXPECT_EQ(aligned_seen, 30);
  EXPECT_GT(looser_seen, 0);  // otherwise the inequality has not been tried
}

std::string refusal(const std::function<void()>& build) {
  try {
    build();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST_F(Skip, MemoryIsStatedBeforehandAndKeptTo) {
  Random random(14);
  Volume volume = random_volume(random, VoxelType::uint8, 4);
  volume.info.dims = {40, 33, 29};
  volume.voxels.resize(volume.info.byte_count());
  for (std::size_t i = 0; i < volume.voxels.size(); ++i)
    volume.voxels[i] = static_cast<std::byte>(i % 251);
  MemorySource source(volume);
  const VoxelStatistics statistics = scan(volume);
  const VolumeOnDevice on_device(device(), source);
  for (const SkipKind kind : {SkipKind::block, SkipKind::distance_map, SkipKind::partitioned,
                              SkipKind::bitmask, SkipKind::octree}) {
    for (const RangeMinima minima :
         {RangeMinima::none, RangeMinima::segment_tree, RangeMinima::sparse_table}) {
      SkipOptions options;
      options.kind = kind;
      options.partitions = 16;
      options.range_minima = minima;
      const SkipMemory planned = skip_memory(volume.info, options);
      const auto structure = make_skip_structure(kernels(), {on_device, statistics}, options);
      if (kind == SkipKind::octree) {
        EXPECT_LE(structure->device_bytes(), planned.kept_bytes);
      } else {
        EXPECT_EQ(structure->device_bytes(), planned.kept_bytes) << to_string(kind);
      }
      options.memory_bytes_max = 1000;
      const std::string message = refusal([&] {
        make_skip_structure(kernels(), {on_device, statistics}, options);
      });
      EXPECT_NE(message.find(planned.formula), std::string::npos) << message;
    }
  }
}

TEST_F(Skip, PartitionedMemoryIsPartitionsTimesBlocks) {
  VolumeInfo info;
  info.dims = {512, 512, 460};
  SkipOptions options;
  options.kind = SkipKind::partitioned;
  EXPECT_EQ(skip_memory(info, options).kept_bytes, (64u + 1u) * 128u * 128u * 115u);
  options.kind = SkipKind::bitmask;  // an eighth, and the map itself
  EXPECT_EQ(skip_memory(info, options).kept_bytes, 65u * 128u * 128u * 115u / 8u + 128u * 128u * 115u);
}

TEST_F(Skip, LazyPartitionsMakeOnlyWhatATransferFunctionHasShown) {
  Random random(15);
  Volume volume = random_volume(random, VoxelType::uint8, 3);
  volume.info.dims = {24, 20, 16};
  volume.voxels.resize(volume.info.byte_count());
  for (auto& voxel : volume.voxels)
    voxel = static_cast<std::byte>(random_int(random, 0, 255));
  MemorySource source(volume);
  const VoxelStatistics statistics = scan(volume);
  const VolumeOnDevice on_device(device(), source);
  SkipOptions options;
  options.kind = SkipKind::partitioned;
  options.lazy = true;
  const auto structure = make_skip_structure(kernels(), {on_device, statistics}, options);
  const std::uint64_t nothing = structure->device_bytes();
  const std::uint64_t map = structure->grid().map_bytes();
  gpu::CommandList commands(device(), "test");
  std::vector<bool> visible(256);
  visible[9] = true;  // felt in (8, 10): partition 2
  structure->update(commands, table_of({0, 255}, visible));
  submit(commands);
  EXPECT_EQ(structure->device_bytes(), nothing + 8 * map);  // a piece of eight, one of them made
  for (std::size_t i = 0; i < 32; ++i)
    visible[i] = true;  // partitions 0 … 7
  commands.reset();
  structure->update(commands, table_of({0, 255}, visible));
  submit(commands);
  EXPECT_EQ(structure->device_bytes(), nothing + 8 * map);
}

TEST_F(Skip, AThousandUpdatesTakeNoMoreMemoryThanOne) {
  Random random(16);
  const Volume volume = random_volume(random, VoxelType::uint8, 12);
  MemorySource source(volume);
  const VoxelStatistics statistics = scan(volume);
  const VolumeOnDevice on_device(device(), source);
  for (const SkipKind kind : {SkipKind::block, SkipKind::partitioned, SkipKind::bitmask, SkipKind::octree}) {
    SkipOptions options;
    options.kind = kind;
    const auto structure = make_skip_structure(kernels(), {on_device, statistics}, options);
    gpu::CommandList commands(device(), "test");
    std::uint64_t bytes = 0;
    const int updates = kind == SkipKind::partitioned ? 1000 : 50;
    for (int i = 0; i < updates; ++i) {
      commands.reset();
      structure->update(commands, random_table(random, statistics));
      if (kind != SkipKind::octree) submit(commands);
      if (i == 0) bytes = structure->device_bytes();
    }
    EXPECT_EQ(structure->device_bytes(), bytes) << to_string(kind);
  }
}

TEST_F(Skip, CachedPlanesEqualThoseBuiltAndADamagedFileIsBuiltAnew) {
  Random random(17);
  const Volume volume = random_volume(random, VoxelType::uint8, 12);
  MemorySource source(volume);
  const VoxelStatistics statistics = scan(volume);
  const VolumeOnDevice on_device(device(), source);
  const BlockGrid grid(volume.info, 4);
  SkipOptions options;
  options.cache_folder = std::filesystem::path(testing::TempDir()) / "brace_skip_cache_test";
  std::filesystem::remove_all(options.cache_folder);
  const Partitioning partitioning = uniform_partitions(VoxelType::uint8, {0, 255}, 16);
  const SkipScene scene{on_device, statistics};
  const auto planes = [&] {
    const BitPlanes made = cached_planes(kernels(), scene, grid, partitioning, options, {});
    std::vector<oracle::BlockValues> all;
    for (int p = 0; p < 16; ++p)
      all.push_back(bits(made.buffer(), p, grid));
    return all;
  };
  const auto built = planes();
  const auto file = *std::filesystem::directory_iterator(options.cache_folder);
  EXPECT_EQ(planes(), built);
  const auto written = std::filesystem::last_write_time(file);
  EXPECT_EQ(planes(), built);
  EXPECT_EQ(std::filesystem::last_write_time(file), written);  // it was read
  std::filesystem::resize_file(file.path(), 20);
  EXPECT_EQ(planes(), built);
  EXPECT_GT(std::filesystem::file_size(file.path()), 20u);  // and written anew
  std::filesystem::remove_all(options.cache_folder);
}

TEST_F(Skip, OptionsOutOfRangeAreRefused) {
  Random random(18);
  const Volume volume = random_volume(random, VoxelType::uint8, 4);
  MemorySource source(volume);
  const VoxelStatistics statistics = scan(volume);
  const VolumeOnDevice on_device(device(), source);
  SkipOptions options;
  options.kind = SkipKind::partitioned;
  options.partitions = 257;
  EXPECT_NE(refusal([&] {
              make_skip_structure(kernels(), {on_device, statistics}, options);
            }).find("1 to 256"),
            std::string::npos);
  options.partitions = 64;
  options.block_voxels = 1;
  EXPECT_NE(refusal([&] {
              make_skip_structure(kernels(), {on_device, statistics}, options);
            }).find("2 to 16"),
            std::string::npos);
}

}  // namespace
}  // namespace brace
