#include "hmd_sim/trace_io.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "hmd_sim/trace_generators.hpp"
#include "hmd_sim/trace_info.hpp"

namespace brace::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path source_dir = BRACE_SOURCE_DIR;

std::string message_of(const std::string& text, const TraceReadOptions& options = {}) {
  try {
    parse_trace(text, "some.txt", options);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

std::string written(const PoseTrace& trace, TraceFormat format) {
  std::ostringstream out;
  write_trace(out, trace, format, {"a note"});
  return out.str();
}

void expect_identical(const PoseTrace& a, const PoseTrace& b) {
  ASSERT_EQ(a.poses().size(), b.poses().size());
  for (std::size_t i = 0; i < a.poses().size(); ++i) {
    EXPECT_EQ(a.poses()[i].time, b.poses()[i].time);
    EXPECT_EQ(a.poses()[i].world_from_head.position, b.poses()[i].world_from_head.position);
    EXPECT_EQ(a.poses()[i].world_from_head.orientation, b.poses()[i].world_from_head.orientation);
  }
}

TEST(TraceIo, EveryWrittenFormatReadsBackBitForBit) {
  const PoseTrace trace =
      generate_trace({.motion = Motion::natural, .seconds = 2, .seed = 4, .rate = {90, 1}});
  for (const TraceFormat format : {TraceFormat::brace, TraceFormat::tum, TraceFormat::euroc}) {
    const TraceReadResult back =
        parse_trace(written(trace, format), "folder/natural.trace", {.strict = true});
    EXPECT_EQ(back.format, format);
    EXPECT_EQ(back.trace.name(), "natural");
    EXPECT_EQ(back.repairs.dropped() + back.repairs.renormalised + back.repairs.sign_flips, 0u);
    expect_identical(trace, back.trace);
  }
}

TEST(TraceIo, WritesToAFileAndLeavesNoneBehindWhenItCannot) {
  const PoseTrace trace = generate_trace({.motion = Motion::rotation, .rate = {90, 1}});
  const auto path = std::filesystem::path(testing::TempDir()) / "brace_written.trace";
  write_trace(path, trace, TraceFormat::brace);
  expect_identical(trace, read_trace(path).trace);
  EXPECT_THROW(write_trace("/nonexistent/folder/x.trace", trace, TraceFormat::brace), Error);
  EXPECT_THROW(write_trace(path, trace, TraceFormat::aframe), Error);
  if (std::filesystem::exists("/dev/full")) {
    const auto full = std::filesystem::path(testing::TempDir()) / "brace_full.trace";
    std::filesystem::remove(full);
    auto partial = full;
    partial += ".partial";
    std::filesystem::create_symlink("/dev/full", partial);
    EXPECT_THROW(write_trace(full, trace, TraceFormat::brace), Error);
    EXPECT_FALSE(std::filesystem::exists(full));
    EXPECT_FALSE(std::filesystem::is_symlink(partial));
  }
}

TEST(TraceIo, TumTimesKeepTheirNanosecondsAtEpochTimes) {
  const TraceReadResult tum = parse_trace(
      "# ground truth\n"
      "1305031098.665912345 1.0 2.0 3.0 0 0 0 1\n"
      "1305031098.675912346 1.5 2.0 3.0 0 0.0998334166468 0 0.99500416527803\n",
      "a.txt");
  EXPECT_EQ(tum.format, TraceFormat::tum);
  EXPECT_EQ(to_ns(tum.trace.begin_time()), 1305031098665912345);
  EXPECT_EQ(to_ns(tum.trace.end_time()), 1305031098675912346);
  EXPECT_NEAR(quat_log(tum.trace.poses()[1].world_from_head.orientation).y, 0.2, 1e-9);
}

TEST(TraceIo, EurocHasNanosecondsAndTheRealPartFirst) {
  const TraceReadResult euroc = parse_trace(
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
      "1403636579763555584,4.688,-1.786,0.783,0.534108,-0.153029,-0.827383,-0.082152,0,0,0,0,0,0,0,0,0\r\n"
      "1403636579768555584,4.689,-1.786,0.783,0.534108,-0.153029,-0.827383,-0.082152,0,0,0,0,0,0,0,0,0\r\n",
      "mav0.csv");
  EXPECT_EQ(euroc.format, TraceFormat::euroc);
  EXPECT_EQ(to_ns(euroc.trace.begin_time()), 1403636579763555584);
  EXPECT_NEAR(euroc.trace.poses()[0].world_from_head.orientation.w, 0.534108, 1e-6);
  EXPECT_NEAR(euroc.trace.poses()[0].world_from_head.orientation.z, -0.082152, 1e-6);
}

TEST(TraceIo, AFrameAnglesAreYxzEulerDegrees) {
  const TraceReadResult aframe = parse_trace(
      R"({"camera": {"poses": [
        {"position": {"x": 1, "y": 2, "z": 3}, "rotation": {"x": 30, "y": 90, "z": 0}, "timestamp": 1.5},
        {"position": {"x": 1, "y": 2, "z": 3}, "rotation": {"x": 30, "y": 90, "z": 20}, "timestamp": 12.25}]}})",
      "r.json");
  EXPECT_EQ(aframe.format, TraceFormat::aframe);
  EXPECT_EQ(to_ns(aframe.trace.begin_time()), 1'500'000);
  // Yaw 90 to the left looks along -X; the pitch of 30 then lifts the view.
  const glm::dvec3 forward = aframe.trace.poses()[0].world_from_head.orientation * glm::dvec3(0, 0, -1);
  EXPECT_NEAR(forward.x, -std::cos(std::numbers::pi / 6), 1e-12);
  EXPECT_NEAR(forward.y, 0.5, 1e-12);
  // A roll turns about the view direction and leaves it.
  const glm::dvec3 rolled = aframe.trace.poses()[1].world_from_head.orientation * glm::dvec3(0, 0, -1);
  EXPECT_LT(glm::length(rolled - forward), 1e-12);
}

const char* const messy =
    "# header\n"
    "0.00 0 0 0 0 0 0 1\n"
    "0.01 0.1 0 0 0 0 0 -1\n"     // the sign
    "0.02 nan 0 0 0 0 0 1\n"      // dropped
    "0.03 0.3 0 0 0 0 0 1.005\n"  // renormalised
    "0.025 0.3 0 0 0 0 0 1\n"     // backwards
    "0.03 0.3 0 0 0 0 0 1\n"      // the same time
    "0.04 0.4 0 0 0 0 0 1.5\n"    // not unit
    "inf 0.4 0 0 0 0 0 1\n"       // no time
    "0.05 0.4 0 inf 0 0 0 1\n"    // dropped
    "0.20 0.5 0 0 0 0 0 1\n";     // after a gap

TEST(TraceRepair, CountsEverythingRepaired) {
  const TraceReadResult result = parse_trace(messy, "some.txt");
  const TraceRepairs& r = result.repairs;
  EXPECT_EQ(r.poses_read, 10u);
  EXPECT_EQ(r.poses_kept, 4u);
  EXPECT_EQ(r.dropped_non_finite, 3u);
  EXPECT_EQ(r.dropped_bad_quaternion, 1u);
  EXPECT_EQ(r.dropped_time, 2u);
  EXPECT_EQ(r.renormalised, 1u);
  EXPECT_EQ(r.sign_flips, 1u);
  EXPECT_EQ(r.gaps, 1u);
  EXPECT_THAT(r.first_problem, HasSubstr("some.txt:4"));
  EXPECT_THAT(describe(r),
              AllOf(HasSubstr("4 poses of 10"), HasSubstr("2 dropped for a time"), HasSubstr("1 gaps")));
  EXPECT_EQ(result.trace.poses().size(), 4u);
  EXPECT_FALSE(result.trace.valid_at(sim_time(100'000'000)));
}

TEST(TraceRepair, StrictReadingNamesTheFirstBadLine) {
  EXPECT_THAT(message_of(messy, {.strict = true}), AllOf(HasSubstr("some.txt:4"), HasSubstr("NaN")));
  EXPECT_THAT(message_of("0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n0.5 0 0 0 0 0 0 1\n", {.strict = true}),
              AllOf(HasSubstr("some.txt:3"), HasSubstr("not later")));
  EXPECT_EQ(message_of("0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 -1\n", {.strict = true}), "");  // a sign is no fault
}

TEST(TraceRepair, BackwardTimeIsDroppedNotSorted) {
  const TraceReadResult r =
      parse_trace("0.00 0 0 0 0 0 0 1\n0.02 2 0 0 0 0 0 1\n0.01 1 0 0 0 0 0 1\n0.03 3 0 0 0 0 0 1\n", "x");
  ASSERT_EQ(r.trace.poses().size(), 3u);
  EXPECT_EQ(r.trace.poses()[1].world_from_head.position.x, 2.0);
  EXPECT_EQ(r.repairs.dropped_time, 1u);
}

TEST(TraceErrors, UnusableTracesNameFileAndLine) {
  EXPECT_THAT(message_of("0 0 0 0 0 0 0 1\n"), AllOf(HasSubstr("some.txt"), HasSubstr("1 valid pose of 1")));
  EXPECT_THAT(message_of("0 nan 0 0 0 0 0 1\n1 nan 0 0 0 0 0 1\n"),
              AllOf(HasSubstr("0 valid poses of 2"), HasSubstr("some.txt:1")));
  EXPECT_THAT(message_of("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"),
              AllOf(HasSubstr("1 valid pose"), HasSubstr(":2")));
  EXPECT_THAT(message_of(""), HasSubstr("empty"));
  EXPECT_THAT(message_of("# nothing\n\n"), HasSubstr("empty"));
  EXPECT_THAT(message_of("hello\n"), AllOf(HasSubstr("some.txt:1"), HasSubstr("TUM"), HasSubstr("A-Frame")));
  EXPECT_THAT(message_of("a,b,c,d,e,f,g,h,i\n1,2,3,4,5,6,7,8,9\n"), HasSubstr("some.txt:1"));
  EXPECT_THAT(message_of("0 0 0 0 0 0 0 1\n1 0 0 0 zero 0 0 1\n"),
              AllOf(HasSubstr("some.txt:2"), HasSubstr("'zero'")));
  EXPECT_THAT(message_of("0 0 0 0 0 0 0 1\n1 0 0 0\n"),
              AllOf(HasSubstr("some.txt:2"), HasSubstr("4 fields")));
  EXPECT_THAT(message_of("1e300 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"),
              AllOf(HasSubstr("some.txt:1"), HasSubstr("years")));
  EXPECT_THAT(message_of("# brace pose trace 1\n0.5 0 0 0 0 0 0 1\n"),
              AllOf(HasSubstr("some.txt:2"), HasSubstr("nanoseconds")));
  EXPECT_THAT(message_of("# brace pose trace 1\n9223372036854775807 0 0 0 0 0 0 1\n"),
              HasSubstr("some.txt:2"));
  EXPECT_THAT(message_of("{\"camera\":\n{\"poses\": [}}"), HasSubstr("some.txt:2"));
  EXPECT_THAT(message_of("{\"left\": {\"poses\": []}}"), AllOf(HasSubstr("camera.poses"), HasSubstr("left")));
  EXPECT_THAT(message_of("{\"camera\": {\"poses\": [{\"position\": {\"x\": 1}}]}}"),
              AllOf(HasSubstr("pose 1"), HasSubstr("'y'")));
  EXPECT_THAT(message_of("{\"camera\": {\"poses\": [3]}}"), HasSubstr("pose 1"));
  EXPECT_THROW(read_trace("/nonexistent.txt"), Error);
  EXPECT_THROW(read_trace("/tmp"), Error);
}

TEST(TraceErrors, HugePositionsDoNotBecomeInfinite) {
  const TraceReadResult r = parse_trace("0 0 0 0 0 0 0 1\n0.01 1e300 0 0 0 0 0 1\n0.02 0 0 0 0 0 0 1\n", "x");
  EXPECT_EQ(r.repairs.dropped_non_finite, 1u);
}

TEST(ShippedTraces, AreCleanAndSayWhereTheyComeFrom) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_dir / "traces")) {
    if (entry.path().extension() != ".trace") continue;
    ++count;
    const TraceReadResult r = read_trace(entry.path(), {.strict = true});
    EXPECT_EQ(r.format, TraceFormat::brace) << entry.path();
    EXPECT_THAT(describe(r.repairs), HasSubstr("nothing repaired")) << entry.path();
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    EXPECT_THAT(text.str(), AllOf(HasSubstr("licence: MIT"),
                                  testing::AnyOf(HasSubstr("origin: "), HasSubstr("generated: "))));
  }
  EXPECT_GE(count, 6);
  const TraceInfo info = trace_info(read_trace(source_dir / "traces/aframe_tracked_90hz.trace").trace);
  EXPECT_EQ(info.poses, 2568u);
  EXPECT_NEAR(info.duration_s, 29.2, 0.1);
}

TEST(ShippedTraces, GeneratedOnesAreWhatTheGeneratorGives) {
  const PoseTrace rotation = read_trace(source_dir / "traces/rotation_60deg_1s.trace").trace;
  for (const TimedPose& pose : rotation.poses()) {
    const Pose want = rotation_pose(60, 1.0, to_s(pose.time));
    EXPECT_LT(angle_between_rad(pose.world_from_head.orientation, want.orientation), 1e-14);
    EXPECT_LT(glm::length(pose.world_from_head.position - want.position), 1e-14);
  }
}

std::filesystem::path shared_traces() {
  const char* variable = std::getenv("BRACE_SHARED_DIR");
  return (variable != nullptr ? std::filesystem::path(variable) : source_dir / "../shared") / "data/traces";
}

TEST(SharedTraces, EveryAnnotatedTraceReadsWithoutADrop) {
  if (!std::filesystem::exists(shared_traces())) GTEST_SKIP() << "no shared data at " << shared_traces();
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(shared_traces())) {
    if (entry.path().extension() != ".txt") continue;
    ++count;
    const TraceReadResult r = read_trace(entry.path(), {.strict = true});
    EXPECT_EQ(r.format, TraceFormat::tum) << entry.path();
    EXPECT_EQ(r.repairs.dropped(), 0u);
  }
  EXPECT_GE(count, 1);
}

TEST(SharedTraces, AFrameReaderAgreesWithAnIndependentConversion) {
  const auto json = shared_traces() / "orig/aframe_grabLeft.json",
             text = shared_traces() / "aframe_grabLeft_90hz.txt";
  if (!std::filesystem::exists(json)) GTEST_SKIP() << "no shared data at " << shared_traces();
  const PoseTrace ours = shifted_to(read_trace(json).trace, sim_time(0)), other = read_trace(text).trace;
  ASSERT_EQ(ours.poses().size(), other.poses().size());
  for (std::size_t i = 0; i < ours.poses().size(); ++i) {
    const Pose& a = ours.poses()[i].world_from_head;
    const Pose& b = other.poses()[i].world_from_head;
    EXPECT_NEAR(to_s(ours.poses()[i].time), to_s(other.poses()[i].time), 1e-6);
    EXPECT_LT(glm::length(a.position - b.position), 2e-6);
    EXPECT_LT(angle_between_rad(a.orientation, b.orientation), 1e-6);
  }
}

}  // namespace
}  // namespace brace::sim
