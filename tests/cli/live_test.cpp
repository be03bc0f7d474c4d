// brace live on a virtual display.
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/image.hpp"
#include "hmd_sim/trace_io.hpp"
#include "tests/cli/live_fixture.hpp"
#include "tools/live/window_picture.hpp"

namespace brace {
namespace {

using test::differing_pixels;
using test::live_session;
using test::Outcome;
using test::replayed_eyes;
using test::RunOptions;
using test::Workplace;
using Live = test::Live;
using ::testing::HasSubstr;

TEST(LiveWithoutADisplay, SaysWhatToDo) {
  const Workplace place;
  place.write("s.toml", live_session);
  RunOptions options;
  options.environment = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}};
  const Outcome outcome = place.brace({"live", "s.toml", "--set", "trace.neck.motion=still"}, options);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("xvfb-run"));
  EXPECT_THAT(outcome.err, HasSubstr("brace run"));
}

TEST_F(Live, ShowsTheEyesThatTheReplayShows) {
  write_session("still");
  const Outcome run = place_.brace({"run", "s.toml", "--out", "run"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Outcome live =
      place_.brace({"live", "s.toml", "--keep-scale", "--frames", "3", "--screenshot", "eyes.png"}, display_);
  ASSERT_EQ(live.exit_code, 0) << live.err << live.out;
  const ImageRgba8 both = read_png(place_ / "eyes.png");
  EXPECT_EQ(differing_pixels(both, replayed_eyes(place_, "run", 3)), 0);
}

/// Pixels of the overlay's strip in the colour of a fault's words.
int fault_pixels(const ImageRgba8& window) {
  int count = 0;
  for (int y = window.height_px - WindowLayout::strip_height_px; y < window.height_px; ++y)
    for (int x = 0; x < window.width_px - WindowLayout::column_width_px; ++x)
      count += window.at(x, y).r > 240 && window.at(x, y).g < 100;
  return count;
}

TEST_F(Live, ShowsTheOverlayInTheWindowAndNeverInTheEyes) {
  write_session("still");
  const auto show = [&](const char* name, const std::string& keys) {
    place_.write("drive.sh", R"(
"$1" live s.toml --keep-scale --frames 5000 --screenshot eyes-$2.png --screenshot-window window-$2.png >live.log 2>&1 &
live=$!
for i in $(seq 600); do
  window=$(xdotool search --name ' fps' 2>/dev/null | head -1); [ -n "$window" ] && break; sleep 0.05
done
xdotool mousemove 300 300
)" + keys + "\nsleep 0.5; xdotool key Escape; wait $live\n");
    const Outcome outcome = place_.command({"/bin/bash", "drive.sh", BRACE_PROGRAM, name}, display_);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err << place_.read("live.log");
  };
  show("with", "");
  show("without", "xdotool key h");
  const ImageRgba8 with = read_png(place_ / "window-with.png"),
                   without = read_png(place_ / "window-without.png");
  ASSERT_EQ(with.width_px, without.width_px);
  const Rgba8 background = with.at(with.width_px - 2, with.height_px - 2);
  EXPECT_NE(background, (Rgba8{0, 0, 0, 255})) << "the column's";
  EXPECT_EQ(without.at(with.width_px - 2, with.height_px - 2), (Rgba8{0, 0, 0, 255}));
  EXPECT_EQ(read_png(place_ / "eyes-with.png").pixels, read_png(place_ / "eyes-without.png").pixels);
}

TEST_F(Live, FollowsMouseAndKeysReloadsStagesAndSaysWhatDoesNotCompile) {
  write_session("still");
  ASSERT_EQ(place_.brace({"new-stage", "cast", "mine", "--out", "mine"}).exit_code, 0);
  place_.write("drive.sh", R"(
"$1" live s.toml --set pipeline.cast=mine --plugin-path mine --keep-scale --rate 60 --frames 5000 --screenshot eyes.png >live.log 2>&1 &
live=$!
for i in $(seq 600); do
  window=$(xdotool search --name ' fps' 2>/dev/null | head -1); [ -n "$window" ] && break; sleep 0.1
done
xdotool mousemove 300 300
xdotool key r; sleep 0.3
xdotool mousedown 1
for i in 1 2 3 4 5 6; do xdotool mousemove_relative 12 0; sleep 0.1; done
xdotool mouseup 1; xdotool keydown w; sleep 0.3; xdotool keyup w; sleep 0.2
xdotool key r; sleep 0.3
cp mine/mine.glsl good
echo 'no such thing' >>mine/mine.glsl
for i in $(seq 300); do grep -q 'mine.glsl:' live.log && break; sleep 0.1; done
xdotool key p
for i in $(seq 100); do ls live-*-window.png 2>/dev/null && break; sleep 0.1; done
sleep 1.1
mv live-*-window.png broken.png
cp good mine/mine.glsl
for i in $(seq 300); do grep -q 'reloaded' live.log && break; sleep 0.1; done
xdotool key Escape
wait $live
)");
  const Outcome outcome = place_.command({"/bin/bash", "drive.sh", BRACE_PROGRAM}, display_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err << place_.read("live.log");
  const std::string log = place_.read("live.log");
  EXPECT_THAT(log, HasSubstr("mine/mine.glsl:"));
  EXPECT_THAT(log, HasSubstr("live: reloaded"));
  const ImageRgba8 window = read_png(place_ / "broken.png");
  EXPECT_GT(fault_pixels(window), 200) << "the compiler's words";
  // Dragged to the right by 72 pixels: about 0.29 rad.
  const sim::PoseTrace trace = sim::read_trace(place_ / "live.trace").trace;
  const auto yaw = [](const Pose& pose) {
    const glm::dvec3 forward = pose.orientation * glm::dvec3(0.0, 0.0, -1.0);
    return std::atan2(forward.x, -forward.z);
  };
  const double turned =
      yaw(trace.poses().back().world_from_head) - yaw(trace.poses().front().world_from_head);
  EXPECT_GT(turned, 0.15);
  EXPECT_LT(turned, 0.35);
  EXPECT_GT(glm::distance(trace.poses().back().world_from_head.position,
                          trace.poses().front().world_from_head.position),
            0.05)
      << "by keys";
  // Where the hand has left the head, the replay's eyes see what the window's did.
  const int last = static_cast<int>(to_s(trace.end_time() - trace.begin_time()) * 90.0) - 3;
  const Outcome replay = test::run_session(place_, test::live_session_on("live.trace"), "replay",
                                           {"pipeline.cast=mine", fmt::format("run.frames={}", last + 1),
                                            fmt::format("output.images=list:{}", last)},
                                           {"--plugin-path", "mine"});
  ASSERT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_EQ(differing_pixels(read_png(place_ / "eyes.png"), replayed_eyes(place_, "replay", last)), 0);
}

TEST_F(Live, SwitchesStagesByMouseAndSaysWhatDoesNotGoTogether) {
  write_session("still");
  const std::string log = drive("--screenshot eyes.png", R"sh(
fold Figures Stages; click Stages pipeline.warp
click pipeline.warp pipeline.warp=volumetric; click pipeline.warp=volumetric; said 'pipeline.warp = volumetric in'
click pipeline.stereo pipeline.stereo=novel_view; click pipeline.stereo=novel_view; said 'is refused'
click pipeline.rays pipeline.rays=mab; click pipeline.rays=mab; said 'pipeline.rays = mab in'
)sh");
  EXPECT_THAT(log, HasSubstr("live: pipeline.warp = volumetric in "));
  EXPECT_THAT(log,
              HasSubstr("live: pipeline.stereo = novel_view is refused: warp/volumetric does not work with"));
  // The next choice is made with the stereo stage of before.
  EXPECT_THAT(log, HasSubstr("live: pipeline.rays = mab in "));
  EXPECT_TRUE(std::filesystem::exists(place_ / "eyes.png"));
}

TEST_F(Live, RefusesWhatItCannotShow) {
  place_.write("s.toml", live_session + "[compare]\nkey = 'run.seed'\nvalues = [1, 2]\n");
  const Outcome compare = place_.brace({"live", "s.toml", "--set", "trace.neck.motion=still"}, display_);
  EXPECT_EQ(compare.exit_code, 2);
  EXPECT_THAT(compare.out + compare.err, HasSubstr("[compare]"));
  for (const char* option : {"--record", "--screenshot", "--screenshot-window", "--widgets"}) {
    const Outcome outcome = place_.brace({"live", "s.toml", option, "nowhere/file"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err,
                HasSubstr(std::string(option) + " nowhere/file: cannot be written there; accepted: "));
  }
  EXPECT_EQ(place_.brace({"live", "no.toml"}, display_).exit_code, 2);
  EXPECT_EQ(place_.brace({"live", "s.toml", "--rate", "0"}, display_).exit_code, 2);
}

}  // namespace
}  // namespace brace
