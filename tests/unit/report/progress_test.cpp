#include "runtime/report/progress.hpp"

#include <gtest/gtest.h>

namespace brace {
namespace {

TEST(Progress, BarNeverLeavesTheTerminalsWidth) {
  for (int columns = 1; columns < 120; ++columns) {
    for (const std::uint64_t done : {0u, 1u, 450u, 900u, 1000u}) {
      EXPECT_LE(progress_bar_line("casting", "vsyncs", done, 900, 3.0, columns).size(),
                static_cast<std::size_t>(columns));
    }
  }
}

TEST(Progress, BarTellsShareCountAndTimeLeft) {
  EXPECT_EQ(progress_bar_line("casting", "vsyncs", 450, 900, 12.0, 100),
            "casting  [===============               ]   50 %  450/900 vsyncs  0:12 left");
  EXPECT_EQ(progress_bar_line("casting", "vsyncs", 900, 900, 12.0, 100),
            "casting  [==============================]  100 %  900/900 vsyncs");
}

TEST(Progress, LogLineIsPlain) {
  EXPECT_EQ(progress_log_line("casting", "vsyncs", 225, 900, 10.0),
            "casting: 25 % (225/900 vsyncs), 0:30 left");
}

TEST(Progress, WithoutAUnitOnlyTheShareIsTold) {
  EXPECT_EQ(progress_log_line("reading", "", 25, 100, 10.0), "reading: 25 %, 0:30 left");
  EXPECT_EQ(progress_bar_line("reading", "", 100, 100, 10.0, 60),
            "reading  [==============================]  100 %");
}

TEST(Progress, DurationsReadLikeAClock) {
  EXPECT_EQ(duration_text(0.4), "0:00");
  EXPECT_EQ(duration_text(9.0), "0:09");
  EXPECT_EQ(duration_text(754.0), "12:34");
  EXPECT_EQ(duration_text(3723.0), "1:02:03");
}

TEST(Progress, AShortTaskInALogSaysNothing) {
  std::FILE* log = std::tmpfile();
  ASSERT_NE(log, nullptr);
  {
    ProgressMeter progress("quick", 1000, "", log);
    for (std::uint64_t i = 0; i <= 1000; ++i)
      progress.update(i);
    progress.finish();
  }
  EXPECT_EQ(std::ftell(log), 0);
  std::fclose(log);
}

}  // namespace
}  // namespace brace
