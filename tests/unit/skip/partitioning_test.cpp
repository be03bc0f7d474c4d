#include "runtime/skip/partitioning.hpp"

#include <numeric>

#include <gtest/gtest.h>

#include "runtime/skip/structures.hpp"
#include "skip/skip_fixture.hpp"

namespace brace {
namespace {

TEST(Partitioning, Skip_UniformPartitionsCoverEveryKeyOnce) {
  for (const VoxelType type : {VoxelType::uint8, VoxelType::int16, VoxelType::uint16, VoxelType::float32}) {
    for (const int n : {1, 2, 3, 16, 100, 256}) {
      const Partitioning p = uniform_partitions(type, {-20.0, 230.0}, n);
      EXPECT_LE(p.count(), n);
      EXPECT_EQ(p.first_key.front(), 0u);
      EXPECT_EQ(p.first_key.back(), key_count(type));
      for (std::size_t i = 1; i < p.first_key.size(); ++i)
        EXPECT_GT(p.first_key[i], p.first_key[i - 1]);
      for (std::uint32_t key = 0; key < key_count(type); key += 7) {
        const auto part = static_cast<std::size_t>(p.partition_of(key));
        EXPECT_TRUE(p.first_key[part] <= key && key < p.first_key[part + 1]);
      }
    }
  }
}

TEST(Partitioning, Skip_TwoHundredAndFiftySixPartitionsOfBytesAreTheValues) {
  const Partitioning p = uniform_partitions(VoxelType::uint8, {0, 255}, 256);
  ASSERT_EQ(p.count(), 256);
  for (std::uint32_t key = 0; key < 256; ++key)
    EXPECT_EQ(p.partition_of(key), static_cast<int>(key));
}

TEST(Partitioning, Skip_SixtyFourPartitionsOfBytesHoldFourValuesEach) {
  const Partitioning p = uniform_partitions(VoxelType::uint8, {0, 255}, 64);
  ASSERT_EQ(p.count(), 64);
  for (std::size_t i = 0; i <= 64; ++i)
    EXPECT_EQ(p.first_key[i], 4 * i);
}

TEST(Partitioning, Skip_MinimumApartGivesTheSmallestValueItsOwnPartition) {
  const Partitioning p = minimum_apart(VoxelType::uint8, {17, 255}, 64);
  EXPECT_EQ(p.first_key[1], 18u);
  EXPECT_LE(p.count(), 64);
  EXPECT_EQ(minimum_apart(VoxelType::uint8, {9, 9}, 64).count(), 1);  // a constant volume has one value
}

TEST(Partitioning, Skip_AdaptiveBordersFollowTheTransferFunctions) {
  Volume volume;
  volume.info.dims = {64, 64, 1};
  volume.voxels.resize(4096);
  for (std::size_t i = 0; i < 4096; ++i)
    volume.voxels[i] = static_cast<std::byte>(i % 200);
  const VoxelStatistics statistics = scan(volume);
  const std::vector<TransferTable> tables = {paper_table(3, {0, 255}), paper_table(6, {0, 255})};
  const Partitioning p = adaptive_partitions(statistics, tables, 12);
  EXPECT_EQ(p.count(), 12);
  for (const TransferTable& table : tables) {  // every partition is all visible or all invisible
    const auto below = Visibility(table).visible_below(VoxelType::uint8);
    for (std::size_t i = 0; i + 1 < p.first_key.size(); ++i) {
      const std::uint32_t keys = p.first_key[i + 1] - p.first_key[i];
      const std::uint32_t shown = below[p.first_key[i + 1]] - below[p.first_key[i]];
      EXPECT_TRUE(shown == 0 || shown == keys) << "partition " << i;
    }
  }
}

TEST(Visibility, Skip_IntervalIsVisibleExactlyWhereTheTableAbsorbs) {
  Random random(3);
  for (int repeat = 0; repeat < 200; ++repeat) {
    std::vector<bool> visible(256);
    for (std::size_t i = 0; i < 256; ++i)
      visible[i] = random_int(random, 0, 20) == 0;
    const TransferTable table = table_of({0, 255}, visible);
    const Visibility visibility(table);
    const int low = random_int(random, 0, 255), high = random_int(random, low, std::min(255, low + 12));
    const ValueRange range{static_cast<double>(low), static_cast<double>(high)};
    EXPECT_EQ(visibility.in(range), oracle::absorbs_in(table, range)) << low << " … " << high;
    const ValueRange half{low + 0.5, high + 0.5};
    EXPECT_EQ(visibility.in(half), oracle::absorbs_in(table, half)) << low << " … " << high << " and a half";
  }
}

TEST(Visibility, Skip_AbsorptionFadesOutOneEntryBeyondTheLastVisibleOne) {
  std::vector<bool> visible(256);
  visible[100] = true;
  const Visibility visibility(table_of({0, 255}, visible));
  EXPECT_FALSE(visibility.in({99, 99}));
  EXPECT_TRUE(visibility.in({99.01, 99.01}));
  EXPECT_TRUE(visibility.in({100.99, 100.99}));
  EXPECT_FALSE(visibility.in({101, 101}));
}

TEST(Visibility, Skip_SlackOfFilteringLeavesABackgroundOfZerosInvisible) {
  std::vector<bool> visible(256, true);
  visible[0] = false;
  visible[8] = visible[9] = visible[10] = false;
  const Visibility filtered(table_of({0, 255}, visible), {0x1p-16, 0.0, 0.0});
  EXPECT_FALSE(filtered.in({0, 0}));
  EXPECT_FALSE(filtered.in({9, 9}));
  EXPECT_TRUE(filtered.in({10, 10}));  // a hair above 10 is visible
  EXPECT_FALSE(Visibility(table_of({0, 255}, visible)).in({10, 10}));
}

TEST(RangeCover, Skip_EveryRunIsCoveredByFewMaps) {
  Random random(5);
  for (const RangeMinima kind : {RangeMinima::none, RangeMinima::segment_tree, RangeMinima::sparse_table}) {
    for (const int n : {1, 2, 3, 5, 8, 13, 64}) {
      const RangeCover cover(kind, n);
      std::vector<int> value(static_cast<std::size_t>(cover.maps()), -1);
      for (int p = 0; p < n; ++p)
        value[static_cast<std::size_t>(p)] = random_int(random, 0, 1000);
      for (const auto& pair : cover.pairs()) {
        ASSERT_GE(value[static_cast<std::size_t>(pair.a)], 0);  // made before
        ASSERT_GE(value[static_cast<std::size_t>(pair.b)], 0);
        value[static_cast<std::size_t>(pair.map)] =
            std::min(value[static_cast<std::size_t>(pair.a)], value[static_cast<std::size_t>(pair.b)]);
      }
      EXPECT_EQ(std::count(value.begin(), value.end(), -1), 0);
      for (int begin = 0; begin < n; ++begin) {
        for (int end = begin + 1; end <= n; ++end) {
          std::vector<int> maps;
          cover.cover({begin, end}, maps);
          int covered = 1001;
          for (const int map : maps)
            covered = std::min(covered, value[static_cast<std::size_t>(map)]);
          EXPECT_EQ(covered, *std::min_element(value.begin() + begin, value.begin() + end));
          if (kind == RangeMinima::sparse_table) {
            EXPECT_LE(maps.size(), 2u);
          }
          if (kind == RangeMinima::segment_tree && n == 64) {
            EXPECT_LE(maps.size(), 12u);
          }
        }
      }
    }
  }
}

TEST(RangeCover, Skip_HalfTheRangeIsOneMapOfTheSegmentTree) {
  std::vector<int> maps;
  RangeCover(RangeMinima::segment_tree, 64).cover({32, 64}, maps);
  EXPECT_EQ(maps.size(), 1u);
}

}  // namespace
}  // namespace brace
