#include <gtest/gtest.h>

#include "runtime/skip/choose_skip.hpp"
#include "skip/skip_fixture.hpp"

namespace brace {
namespace {

VolumeInfo head() {
  VolumeInfo info;
  info.dims = {512, 512, 460};
  return info;
}

TEST(ChooseSkip, Skip_NoStructureForAFullScene) {
  const VolumeInfo info = head();
  const TransferTable table = paper_table(1, {0, 255});
  for (const bool changes : {false, true}) {
    const SkipChoice choice = choose_skip({info, 0.95, table, changes});
    EXPECT_EQ(choice.options.kind, SkipKind::none);
    EXPECT_NE(choice.reason.find("95.0 %"), std::string::npos) << choice.reason;
  }
}

TEST(ChooseSkip, Skip_DistancesForASparseSceneThatStays) {
  const VolumeInfo info = head();
  const TransferTable table = paper_table(1, {0, 255});
  EXPECT_EQ(choose_skip({info, 0.01, table}).options.kind, SkipKind::distance_map);
  EXPECT_EQ(choose_skip({info, 0.01, table, false, 1000}).options.kind, SkipKind::none);
}

TEST(ChooseSkip, Skip_ChangingTransferFunctionsTakeWhatTheMemoryAllows) {
  const VolumeInfo info = head();
  const TransferTable table = paper_table(3, {0, 255});
  SkipQuestion question{info, 0.2, table, true};
  const SkipChoice most = choose_skip(question);
  EXPECT_EQ(most.options.kind, SkipKind::partitioned);
  EXPECT_EQ(most.options.range_minima, RangeMinima::segment_tree);
  question.memory_bytes_max = skip_memory(info, most.options).kept_bytes - 1;
  const SkipChoice less = choose_skip(question);
  EXPECT_EQ(less.options.range_minima, RangeMinima::none);
  question.memory_bytes_max = 10'000'000;
  EXPECT_EQ(choose_skip(question).options.kind, SkipKind::bitmask);
  question.memory_bytes_max = 3'000'000;
  EXPECT_EQ(choose_skip(question).options.kind, SkipKind::distance_map);
  question.memory_bytes_max = 1000;
  EXPECT_EQ(choose_skip(question).options.kind, SkipKind::none);
}

class ChooseSkipOnDevice : public SkipTest {};

TEST_F(ChooseSkipOnDevice, Skip_OccupiedBlocksAreThoseOfTheOracle) {
  Random random(31);
  for (int repeat = 0; repeat < 12; ++repeat) {
    const VoxelType type = repeat % 2 == 0 ? VoxelType::uint8 : VoxelType::int16;
    const Volume volume = random_volume(random, type, 40);
    MemorySource source(volume);
    const VoxelStatistics statistics = scan(volume);
    const VolumeOnDevice on_device(device(), source, VolumePath::packed);
    const TransferTable table = random_table(random, statistics);
    const BlockGrid grid(volume.info, 4);
    const auto occupied = oracle::occupied(volume, grid, table, Occupancy::cell);
    double count = 0;
    for (const int block : occupied)
      count += block;
    EXPECT_DOUBLE_EQ(occupied_blocks(kernels(), {on_device, statistics}, table),
                     count / static_cast<double>(grid.count()));
  }
}

}  // namespace
}  // namespace brace
