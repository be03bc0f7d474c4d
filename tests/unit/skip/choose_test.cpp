#include <gtest/gtest.h>

#include "runtime/skip/choose_skip.hpp"
#include "skip/skip_fixture.hpp"

namespace brace {
namespace {

/// 512 x 512 x 460 voxels of which a share is 200, the rest 0; only counted, never made.
struct Scene {
  explicit Scene(double full) {
    info.dims = {512, 512, 460};
    statistics.range = {0, 255};
    statistics.voxels = 1000;
    statistics.counts.assign(256, 0);
    statistics.counts[200] = static_cast<std::uint64_t>(1000 * full);
    statistics.counts[0] = 1000 - statistics.counts[200];
  }
  VolumeInfo info;
  VoxelStatistics statistics;
};

TEST(ChooseSkip, Skip_NoStructureForAFullScene) {
  const Scene scene(0.95);
  const TransferTable table = paper_table(1, {0, 255});
  const SkipChoice choice = choose_skip({scene.info, scene.statistics, table});
  EXPECT_EQ(choice.options.kind, SkipKind::none);
  EXPECT_NE(choice.reason.find("95.0 %"), std::string::npos) << choice.reason;
}

TEST(ChooseSkip, Skip_DistancesForASparseSceneThatStays) {
  const Scene scene(0.01);
  const TransferTable table = paper_table(1, {0, 255});
  EXPECT_EQ(choose_skip({scene.info, scene.statistics, table}).options.kind, SkipKind::distance_map);
}

TEST(ChooseSkip, Skip_ChangingTransferFunctionsTakeWhatTheMemoryAllows) {
  const Scene scene(0.2);
  const TransferTable table = paper_table(3, {0, 255});
  SkipQuestion question{scene.info, scene.statistics, table, true};
  const SkipChoice most = choose_skip(question);
  EXPECT_EQ(most.options.kind, SkipKind::partitioned);
  EXPECT_EQ(most.options.range_minima, RangeMinima::segment_tree);
  question.memory_bytes_max = skip_memory(scene.info, most.options).kept_bytes - 1;
  const SkipChoice less = choose_skip(question);
  EXPECT_EQ(less.options.range_minima, RangeMinima::none);
  question.memory_bytes_max = 10'000'000;
  EXPECT_EQ(choose_skip(question).options.kind, SkipKind::bitmask);
  question.memory_bytes_max = 3'000'000;
  EXPECT_EQ(choose_skip(question).options.kind, SkipKind::distance_map);
  question.memory_bytes_max = 1000;
  EXPECT_EQ(choose_skip(question).options.kind, SkipKind::none);
}

}  // namespace
}  // namespace brace
