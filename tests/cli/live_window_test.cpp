// brace live: views, the transfer function's editor, and a window that comes and goes.
#include <filesystem>
#include <sstream>

#include "base/image.hpp"
#include "tests/cli/live_fixture.hpp"

namespace brace {
namespace {

using Live = test::Live;
using test::live_session;
using test::Outcome;
using test::Workplace;
using ::testing::HasSubstr;
using ::testing::Not;

int count_not_black(const ImageRgba8& picture) {
  int count = 0;
  for (const Rgba8& pixel : picture.pixels)
    count += pixel.r != 0 || pixel.g != 0 || pixel.b != 0;
  return count;
}

TEST_F(Live, ShowsViewsByOptionAndByKey) {
  write_session("still");
  const Outcome option = place_.brace(
      {"live", "s.toml", "--keep-scale", "--frames", "2", "--view", "depth", "--screenshot", "depth.png"},
      display_);
  EXPECT_EQ(option.exit_code, 0) << option.err;
  EXPECT_THAT(option.out, HasSubstr("depth: first visible sample"));
  const ImageRgba8 depth = read_png(place_ / "depth.png");
  EXPECT_GT(count_not_black(depth), 100);

  const std::string log = drive("--set pipeline.rays=mab --set pipeline.warp=none", R"sh(
xdotool key 2; said 'view difference in'; xdotool key p
for i in $(seq 100); do ls live-*-difference.png 2>/dev/null && break; sleep 0.1; done
xdotool key 5; said 'skips nothing'
xdotool key 4; said 'view levels in'
click view view=samples; click view=samples; said 'view samples in'; xdotool key p
for i in $(seq 100); do ls live-*-samples.png 2>/dev/null && break; sleep 0.1; done
mv live-*-difference.png difference.png; mv live-*-samples.png samples.png
)sh");
  EXPECT_THAT(log, HasSubstr("samples: samples of each ray"));
  EXPECT_GT(count_not_black(read_png(place_ / "samples.png")), 100);
  const int differing = count_not_black(read_png(place_ / "difference.png"));
  EXPECT_GT(differing, 10) << "fewer rays";
  EXPECT_LT(differing, count_not_black(depth) + 200) << "but the same background";
}

TEST_F(Live, OpensAWindowOfTheSizeAskedFor) {
  write_session("still");
  const Outcome outcome = place_.brace({"live", "s.toml", "--keep-scale", "--frames", "2", "--window", "700",
                                        "400", "--screenshot-window", "window.png"},
                                       display_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const ImageRgba8 window = read_png(place_ / "window.png");
  EXPECT_EQ(window.width_px, 700);
  EXPECT_EQ(window.height_px, 400);
  EXPECT_EQ(place_.brace({"live", "s.toml", "--window", "0", "400"}, display_).exit_code, 2);
}

TEST_F(Live, ChoosesAScaleByWhatEyesAndWindowTakeAndSaysSo) {
  write_session("still");
  const auto said = [&](const std::string& rate) {
    const Outcome outcome = place_.brace({"live", "s.toml", "--frames", "2", "--rate", rate}, display_);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(" ms, window "));
    return outcome.err;
  };
  const std::string slow = said("1"), fast = said("1000");
  EXPECT_THAT(slow, HasSubstr("resolution_scale 0.060 for 1 Hz")) << "the session's";
  EXPECT_THAT(slow, Not(HasSubstr("hardly")));
  EXPECT_THAT(fast, HasSubstr("resolution_scale 0.030 for 1000 Hz"));
  EXPECT_THAT(fast, HasSubstr("1000 Hz will hardly be held here; a lower --rate or a smaller --window will"));
}

TEST_F(Live, RefusesViewsThatThereAreNot) {
  write_session("still");
  const auto refused = [&](const std::string& view) {
    const Outcome outcome = place_.brace(
        {"live", "s.toml", "--keep-scale", "--frames", "2", "--view", view, "--screenshot", "no.png"},
        display_);
    EXPECT_EQ(outcome.exit_code, 2) << view;
    EXPECT_FALSE(std::filesystem::exists(place_ / "no.png"));
    return outcome.err;
  };
  EXPECT_THAT(refused("levels"), HasSubstr("accepted: pipeline.rays = mab"));
  EXPECT_THAT(refused("skip_steps"), HasSubstr("pipeline.skip other than none"));
  EXPECT_THAT(refused("depths"), HasSubstr("depth"));
}

TEST_F(Live, EditsTheTransferFunctionAndSavesWhatItShows) {
  write_session("still", "tf1");
  const std::string log = drive("--screenshot edited.png", R"sh(
fold Figures Stages; click Transfer transfer.plot
for i in $(seq 200); do [ -n "$(at transfer.plot)" ] && break; sleep 0.05; done
for i in 1 2 3 4 5 6; do
  xdotool mousemove $(at transfer.plot); sleep 0.3; xdotool click --repeat 2 --delay 120 1; sleep 0.5
  [ -n "$(at transfer.point.5)" ] && break
done
[ -n "$(at transfer.point.5)" ] || echo "never said: a sixth point" >>live.log
xdotool mousemove $(at transfer.point.3); sleep 0.3; xdotool mousedown 1; sleep 0.3
for i in 1 2 3; do xdotool mousemove_relative -- 4 -10; sleep 0.15; done
xdotool mouseup 1; sleep 0.3
click transfer.save; said 'live-transfer.toml, written'
)sh");
  EXPECT_THAT(log, HasSubstr("transfer function in live-transfer.toml, written"));
  const auto left_eye = [&](const std::string& transfer) {
    const Outcome run = place_.brace(
        {"run", "s.toml", "--out", "run-" + transfer, "--set", "scene.transfer_function=" + transfer});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return read_png(place_ / ("run-" + transfer + "/images/000003_left.png"));
  };
  const ImageRgba8 shown = read_png(place_ / "edited.png");
  const auto differing = [&](const ImageRgba8& left) {
    int count = 0;
    for (int y = 0; y < left.height_px; ++y)
      for (int x = 0; x < left.width_px; ++x) {
        const Rgba8 a = left.at(x, y), b = shown.at(x, y);
        count += std::abs(a.r - b.r) > 1 || std::abs(a.g - b.g) > 1 || std::abs(a.b - b.b) > 1;
      }
    return count;
  };
  EXPECT_EQ(differing(left_eye("live-transfer.toml")), 0) << place_.read("live-transfer.toml");
  EXPECT_GT(differing(left_eye("tf1")), 50);
}

TEST_F(Live, GoesOnWhenItsWindowChangesHidesAndComesBack) {
  write_session("rotation");
  display_.environment["BRACE_VALIDATION"] = "1";  // a message ends it with exit code 3
  const std::string log = drive("--screenshot-window window.png", R"sh(
window=$(xdotool search --name ' fps' | head -1)
for size in "300 200" "1600 900" "1 1" "640 30" "30 640" "2500 1500" "900 500"; do
  xdotool windowsize $window $size; sleep 0.15
done
for i in $(seq 25); do xdotool windowsize $window $((500 + 13 * i)) $((700 - 11 * i)); done
xdotool windowunmap $window; sleep 0.4; xdotool windowmap $window; sleep 0.3
xdotool windowminimize $window; sleep 0.2; xdotool windowmap $window; sleep 0.2
xdotool windowsize --sync $window 800 600; sleep 0.5
)sh");
  EXPECT_THAT(log, HasSubstr("pictures"));
  EXPECT_THAT(log, Not(HasSubstr("validation")));
  const ImageRgba8 window = read_png(place_ / "window.png");
  EXPECT_EQ(window.width_px, 800);
  EXPECT_EQ(window.height_px, 600);
}

TEST_F(Live, SaysWhatToDoWhereADeviceCannotShowPictures) {
  write_session("still");
  // The software device shows nothing on a display of 256 colours.
  const Outcome outcome = place_.command({"/usr/bin/xvfb-run", "-a", "-s", "-screen 0 640x480x8",
                                          BRACE_PROGRAM, "live", "s.toml", "--keep-scale", "--frames", "2"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  for (const char* words : {"cannot show pictures", "--gpu", "Xvfb", "brace run"})
    EXPECT_THAT(outcome.out + outcome.err, HasSubstr(words));
}

TEST_F(Live, CastsFewerRaysWhenTheControlStageSaysSo) {
  write_session("still");
  const auto rays = [&](const std::string& control) {
    const Outcome outcome =
        place_.brace({"live", "s.toml", "--keep-scale", "--frames", "30", "--rate", "1000", "--pace", "free",
                      "--set", "pipeline.rays=mab", "--set", "pipeline.control=" + control},
                     display_);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::size_t at = outcome.out.find("last picture ");
    EXPECT_NE(at, std::string::npos) << outcome.out;
    return std::stoi(outcome.out.substr(at + 13));
  };
  const int all = rays("fixed");
  EXPECT_GT(all, 200);
  EXPECT_LT(rays("mab_dynamic"), all * 9 / 10) << "no picture fits a millisecond";
}

TEST_F(Live, TakesNoMoreMemoryTheLongerItRuns) {
  write_session("rotation");
  display_.environment["ASAN_OPTIONS"] = "detect_leaks=0:quarantine_size_mb=1";
  const std::string log = drive("--pace free", R"sh(
sleep 1
resident() { awk '/VmRSS/ { print $2 }' /proc/$live/status; }
before=$(resident); sleep 3; after=$(resident)
echo "memory $before $after" >>live.log
)sh");
  const std::size_t at = log.find("memory ");
  ASSERT_NE(at, std::string::npos) << log;
  std::istringstream numbers(log.substr(at + 7));
  int before_kib = 0, after_kib = 0;
  numbers >> before_kib >> after_kib;
  ASSERT_GT(before_kib, 10'000);
#if defined(__SANITIZE_ADDRESS__)
  constexpr int most_kib =
      40'000;  // the sanitizer's own allocator comes and goes by 25 MB; a leaked picture is 3 MB
#else
  constexpr int most_kib = 4'000;
#endif
  EXPECT_LT(after_kib - before_kib, most_kib) << log;
}

}  // namespace
}  // namespace brace
