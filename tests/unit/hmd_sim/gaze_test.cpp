#include "hmd_sim/gaze.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "hmd_sim/trace_generators.hpp"
#include "hmd_sim/trace_info.hpp"
#include "hmd_sim/trace_io.hpp"

namespace brace::sim {
namespace {

using testing::HasSubstr;

constexpr double rad_per_degree = std::numbers::pi / 180.0;
const double lost = std::numeric_limits<double>::quiet_NaN();

bool same_gaze(const glm::dvec3& a, const glm::dvec3& b) {
  return a == b || (std::isnan(a.x) && std::isnan(b.x));
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / rad_per_degree;
}

PoseTrace looking(EyeMotion motion, double seconds, double blinks = 0.0, std::uint64_t seed = 1) {
  return generate_trace({.motion = Motion::stationary, .seconds = seconds, .gaze = {motion, blinks, seed}});
}

std::string refusal_of(const std::string& text, bool strict = false) {
  try {
    parse_trace(text, "some.trace", {.strict = strict});
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

TEST(Gaze, AnglesAndTangentsAreThoseOfTheHeadsAxes) {
  EXPECT_NEAR(glm::distance(direction_of_angles(0.0, 0.0), straight_ahead), 0.0, 1e-15);
  const glm::dvec2 left_up = gaze_tangents(direction_of_angles(0.3, 0.2));
  EXPECT_NEAR(left_up.x, -std::tan(0.3), 1e-12) << "yaw is to the left";
  EXPECT_NEAR(left_up.y, std::tan(0.2) / std::cos(0.3), 1e-12);
  EXPECT_NEAR(glm::distance(gaze_tangents(direction_of_tangents({0.4, -1.5})), glm::dvec2(0.4, -1.5)), 0.0,
              1e-12);
}

TEST(Gaze, WhatLooksBesideEveryPictureIsBroughtToItsBorder) {
  EXPECT_EQ(gaze_tangents({1.0, 0.0, 0.0}), glm::dvec2(4.0, 0.0));
  EXPECT_EQ(gaze_tangents({0.0, -0.1, 0.9}), glm::dvec2(0.0, -4.0)) << "behind";
  EXPECT_EQ(gaze_tangents({0.0, 0.0, 1.0}), glm::dvec2(0.0, 0.0));
  EXPECT_EQ(gaze_tangents(glm::normalize(glm::dvec3(8.0, 4.0, -1.0))), glm::dvec2(4.0, 2.0));
}

/// The main sequence: duration and peak velocity go with the amplitude.
TEST(Gaze, SaccadesHaveTheVelocityOfTheirAmplitude) {
  const PoseTrace trace = looking(EyeMotion::saccades, 60.0);
  const std::vector<glm::dvec3>& gaze = trace.gaze();
  int saccades = 0;
  for (std::size_t i = 1; i + 1 < gaze.size(); ++i) {
    if (gaze[i] == gaze[i - 1] || gaze[i - 1] != gaze[i < 2 ? 0 : i - 2]) continue;  // begins at i - 1
    std::size_t end = i;
    double peak_deg_s = 0.0;
    for (; end + 1 < gaze.size() && gaze[end + 1] != gaze[end]; ++end)
      peak_deg_s = std::max(peak_deg_s, degrees_between(gaze[end], gaze[end + 1]) * 1000.0);
    const double amplitude = degrees_between(gaze[i - 1], gaze[end]);
    if (end + 1 >= gaze.size() || amplitude < 2.0) continue;
    ++saccades;
    const double duration_ms = 21.0 + 2.2 * amplitude;
    // The path is straight in angles, not on the sphere: a few per cent.
    EXPECT_NEAR(static_cast<double>(end - i + 1), duration_ms, 0.06 * duration_ms + 2.0);
    EXPECT_NEAR(peak_deg_s, 1875.0 * amplitude / duration_ms, 0.08 * 1875.0 * amplitude / duration_ms);
    i = end;
  }
  EXPECT_GT(saccades, 100) << "two to four a second";
  EXPECT_LT(saccades, 300);
}

TEST(Gaze, PursuitIsSlowEnoughToFollow) {
  const TraceInfo info = trace_info(looking(EyeMotion::pursuit, 20.0));
  EXPECT_GT(info.gaze_speed_deg_s_max, 15.0);
  EXPECT_LT(info.gaze_speed_deg_s_max, 21.0);
  EXPECT_LT(info.gaze_off_deg_max, 14.5);
  EXPECT_EQ(info.gaze_lost, 0u);
}

TEST(Gaze, BlinksAreLostReadingsOf150Ms) {
  const TraceInfo info = trace_info(looking(EyeMotion::saccades, 60.0, 15.0));
  EXPECT_GT(info.blinks, 6u);
  EXPECT_LT(info.blinks, 26u);
  EXPECT_NEAR(static_cast<double>(info.gaze_lost) / static_cast<double>(info.blinks), 150.0, 2.0);
}

TEST(Gaze, ASeedIsAGazeAndAnotherAnother) {
  const PoseTrace a = looking(EyeMotion::saccades, 2.0, 20.0), b = looking(EyeMotion::saccades, 2.0, 20.0),
                  other = looking(EyeMotion::saccades, 2.0, 20.0, 2);
  EXPECT_TRUE(std::equal(a.gaze().begin(), a.gaze().end(), b.gaze().begin(), same_gaze));
  EXPECT_FALSE(std::equal(a.gaze().begin(), a.gaze().end(), other.gaze().begin(), same_gaze));
}

TEST(Gaze, EveryFormatCarriesItThereAndBack) {
  const PoseTrace trace = looking(EyeMotion::saccades, 3.0, 30.0);
  for (const TraceFormat format : {TraceFormat::brace, TraceFormat::tum, TraceFormat::euroc}) {
    std::ostringstream out;
    write_trace(out, trace, format);
    const TraceReadResult back = parse_trace(out.str(), "x", {.strict = true});
    ASSERT_EQ(back.format, format);
    ASSERT_EQ(back.trace.gaze().size(), trace.gaze().size());
    EXPECT_TRUE(std::equal(trace.gaze().begin(), trace.gaze().end(), back.trace.gaze().begin(), same_gaze));
    EXPECT_EQ(back.repairs.gaze_read, trace.gaze().size());
    EXPECT_GT(back.repairs.gaze_lost, 0u);
    EXPECT_EQ(shifted_to(back.trace, sim_time(5)).gaze().size(), trace.gaze().size());
  }
}

TEST(Gaze, TablesOfAnglesAndEmptyCellsAreRead) {
  const TraceReadResult read = parse_trace(
      "#timestamp [ns],x,y,z,w,qx,qy,qz,pupil [mm],gaze_pitch [rad],gaze_yaw [rad]\n"
      "0,0,0,0,1,0,0,0,3.1,0.2,0.3\n10000000,0,0,0,1,0,0,0,,,\n",
      "table.csv");
  EXPECT_NEAR(glm::distance(read.trace.gaze()[0], direction_of_angles(0.3, 0.2)), 0.0, 1e-12);
  EXPECT_TRUE(std::isnan(read.trace.gaze()[1].x));
  EXPECT_THAT(describe(read.repairs), HasSubstr("1 gaze readings lost (the last one holds)"));
}

TEST(Gaze, BadInputIsNamedWithFileAndLine) {
  const std::string head = "# brace pose trace 1\n0 0 0 0 0 0 0 1 0 0 -1\n";
  EXPECT_THAT(refusal_of(head + "1000 0 0 0 0 0 0 1\n"), HasSubstr("some.trace:3: 8 fields"));
  EXPECT_THAT(refusal_of(head + "1000 0 0 0 0 0 0 1 0 0\n"), HasSubstr("some.trace:3: 10 fields"));
  EXPECT_THAT(refusal_of(head + "1000 0 0 0 0 0 0 1 0 b -1\n"), HasSubstr("some.trace:3: field 10 'b'"));
  EXPECT_THAT(refusal_of("#t,x,y,z,w,a,b,c,gaze_x\n0,0,0,0,1,0,0,0,1\n1,0,0,0,1,0,0,0,1\n"),
              HasSubstr("gaze_x, gaze_y and gaze_z, or"));
  EXPECT_THAT(refusal_of("#t,gaze_yaw,gaze_pitch,z,w,a,b,c\n0,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n"),
              HasSubstr("among the first eight"));
  for (const char* bad : {"0 0 1", "0 0 -1.1", "0 0 0", "inf 0 -1"}) {
    const std::string text = head + "1000 0 0 0 0 0 0 1 " + bad + "\n";
    EXPECT_EQ(refusal_of(text), "") << "counted, taken as lost";
    EXPECT_EQ(parse_trace(text, "x").repairs.gaze_bad, 1u) << bad;
    EXPECT_THAT(refusal_of(text, true), HasSubstr("some.trace:3: gaze ("));
  }
  EXPECT_THROW(parse_eye_motion("blink"), Error);
  EXPECT_THROW(looking(EyeMotion::pursuit, 1.0, -1.0), Error);
  EXPECT_THROW(PoseTrace("short", looking(EyeMotion::none, 1.0).poses(), {straight_ahead}), Error);
}

TEST(Gaze, TheLastValidReadingHolds) {
  std::vector<TimedPose> poses;
  for (int i = 0; i < 6; ++i)
    poses.push_back({sim_time(i * 10'000'000), {}});
  const glm::dvec3 left = direction_of_angles(0.2, 0.0), right = direction_of_angles(-0.2, 0.0);
  const PoseTrace trace("held", poses,
                        {glm::dvec3(lost), left, right, glm::dvec3(lost), glm::dvec3(lost), left});
  std::size_t hint = 0;
  const auto at = [&](std::int64_t us) { return trace.gaze_at(sim_time(us * 1000), hint); };
  EXPECT_EQ(at(-5), straight_ahead) << "nothing known yet";
  EXPECT_EQ(at(9'000), straight_ahead);
  EXPECT_EQ(at(10'000), left);
  EXPECT_NEAR(glm::distance(at(15'000), straight_ahead), 0.0, 1e-12) << "half way of a turn";
  EXPECT_NEAR(glm::distance(at(12'500), direction_of_angles(0.1, 0.0)), 0.0, 1e-12) << "along the arc";
  EXPECT_EQ(at(25'000), right) << "no way towards what is lost";
  EXPECT_EQ(at(49'000), right);
  EXPECT_EQ(at(90'000), left);
  std::vector<TimedPose> gap = {{sim_time(0), {}}, {sim_time(60'000'000), {}}};
  EXPECT_EQ(PoseTrace("gap", gap, {left, right}).gaze_at(sim_time(59'000'000), hint), left);
  EXPECT_EQ(PoseTrace("none", gap).gaze_at(sim_time(1), hint), straight_ahead);
}

}  // namespace
}  // namespace brace::sim
