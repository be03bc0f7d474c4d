#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/replay/headset.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

TEST(HeadTraceOf, EveryMotionOfTheNeckIsGenerated) {
  for (const char* motion : {"rotation", "translation", "natural", "still", "spin"}) {
    Session::Trace trace;
    trace.neck = Session::Trace::Neck{.motion = motion, .degrees = 20.0, .seconds = 0.5};
    const HeadTrace head = load_head_trace(trace, BRACE_DATA_DIR);
    EXPECT_NEAR(to_s(head.trace.end_time() - head.trace.begin_time()), 0.5, 1e-3) << motion;
    EXPECT_EQ(head.repairs.poses_read, head.repairs.poses_kept) << motion;
  }
}

TEST(HeadTraceOf, AStillNeckDoesNotMove) {
  Session::Trace trace;
  trace.neck = Session::Trace::Neck{.motion = "still", .seconds = 0.1};
  const HeadTrace head = load_head_trace(trace, BRACE_DATA_DIR);
  for (const auto& pose : head.trace.poses()) {
    EXPECT_EQ(pose.world_from_head.position, head.trace.poses().front().world_from_head.position);
    EXPECT_EQ(pose.world_from_head.orientation, head.trace.poses().front().world_from_head.orientation);
  }
}

TEST(HeadTraceOf, EveryShippedTraceIsFoundByItsName) {
  int found = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(BRACE_DATA_DIR) / "traces")) {
    if (entry.path().extension() != ".trace") continue;
    Session::Trace trace;
    trace.file = entry.path().stem();
    EXPECT_GT(load_head_trace(trace, BRACE_DATA_DIR).trace.poses().size(), 2U) << entry.path();
    ++found;
  }
  EXPECT_GE(found, 6);
}

TEST(HeadTraceOf, AnUnknownNameIsRefusedWithTheNearest) {
  Session::Trace trace;
  trace.file = "aframe_tracked_90h";
  try {
    load_head_trace(trace, BRACE_DATA_DIR);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
    EXPECT_THAT(e.what(), HasSubstr("did you mean 'aframe_tracked_90hz'?"));
  }
}

}  // namespace
}  // namespace brace
