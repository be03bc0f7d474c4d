#include "bench/host.hpp"
#include "gpu/gpu_fixture.hpp"

namespace brace {
namespace {

class HostBench : public gpu::GpuTest {};

TEST_F(HostBench, FramesThroughTheInterfaceAllocateNothing) {
  HostBenchOptions options;
  options.device = &device();
  options.frames = 2'000;
  options.data_folder = BRACE_DATA_FOLDER;
  const HostBenchResult result = bench_host(options);
  ASSERT_EQ(result.cases.back().name, "whole frame");
  for (const HostBenchCase& one : result.cases)
    EXPECT_EQ(one.allocations_per_frame, 0.0) << one.name;
  EXPECT_GT(result.start.cold_s, 0.0);
}

}  // namespace
}  // namespace brace
