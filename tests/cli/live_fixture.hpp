#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/image.hpp"
#include "tests/cli/command.hpp"

namespace brace::test {

inline const std::string live_session = R"([device]
profile = "htc-vive"
resolution_scale = 0.06
tracker = "ideal"
[trace]
neck = { motion = "MOTION", degrees = 30, seconds = 1 }
[scene]
volume = "generator:nested_shells:24"
transfer_function = "ct-soft-tissue"
size_m = 0.5
position = "front:0.7"
[clock]
cost = "model:gtx-1080"
[output]
images = "list:3"
error = "none"
[run]
frames = 4
)";

/// The same on a trace that is shipped or a file.
inline std::string live_session_on(const std::string& trace) {
  std::string text = live_session;
  const std::size_t at = text.find("neck = "), end = text.find('\n', at);
  return text.replace(at, end - at, "file = \"" + trace + "\"");
}

/// For scripts that drive the window: `shown` waits for it; `click` a widget of the overlay by its name,
/// again while that has not brought forth the one named second, as a busy machine draws the overlay late;
/// `fold` a part of the overlay, above the widget named second; `said` waits for words in live.log.
inline const std::string window_functions = R"sh(
shown() { for i in $(seq 600); do xdotool search --name ' fps' >/dev/null 2>&1 && break; sleep 0.05; done; }
at() { awk -v n="$1" '$5 == n { print int($1 + $3 / 2), int($2 + $4 / 2) }' widgets.txt 2>/dev/null; }
there() { for i in $(seq $2); do [ -n "$(at "$1")" ] && return; sleep 0.05; done; false; }
press() {
  xdotool mousemove $(at "$1"); sleep 0.2; xdotool mousedown 1; sleep 0.15; xdotool mouseup 1; sleep 0.15
}
fold() {
  there "$2" 200; was=$(at "$2")
  for try in 1 2 3 4 5; do
    press "$1"; for i in $(seq 60); do [ "$(at "$2")" != "$was" ] && return; sleep 0.05; done
  done
}
click() {
  for try in 1 2 3 4 5; do
    there "$1" 200 || { echo "no widget $1" >>live.log; return; }
    press "$1"
    [ -z "$2" ] && return
    there "$2" 60 && return
  done
  echo "no widget $2" >>live.log
}
said() { for i in $(seq 300); do grep -q -- "$1" live.log && return; sleep 0.1; done; echo "never said: $1" >>live.log; }
)sh";

/// Pixels that differ by more than 1/255.
inline int differing_pixels(const ImageRgba8& a, const ImageRgba8& b) {
  EXPECT_EQ(a.width_px, b.width_px);
  EXPECT_EQ(a.height_px, b.height_px);
  int count = 0;
  for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i) {
    const Rgba8 p = a.pixels[i], q = b.pixels[i];
    count += std::abs(p.r - q.r) > 1 || std::abs(p.g - q.g) > 1 || std::abs(p.b - q.b) > 1;
  }
  return count;
}

/// Both eyes of a vsync as a replay has written them, side by side.
inline ImageRgba8 replayed_eyes(const Workplace& place, const std::string& run, int vsync) {
  const auto eye = [&](const char* name) {
    return read_png(place / fmt::format("{}/images/{:06}_{}.png", run, vsync, name));
  };
  const ImageRgba8 left = eye("left"), right = eye("right");
  ImageRgba8 both(left.width_px + right.width_px, left.height_px);
  for (int y = 0; y < left.height_px; ++y) {
    for (int x = 0; x < left.width_px; ++x)
      both.at(x, y) = left.at(x, y);
    for (int x = 0; x < right.width_px; ++x)
      both.at(left.width_px + x, y) = right.at(x, y);
  }
  return both;
}

class Live : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* tool : {"/usr/bin/xvfb-run", "/usr/bin/xdotool"}) {
      if (!std::filesystem::exists(tool)) GTEST_SKIP() << tool << " is not installed: no window to look at";
    }
    display_.on_virtual_display = true;
  }
  void write_session(const std::string& motion, const std::string& transfer = "ct-soft-tissue") {
    std::string text = live_session;
    text.replace(text.find("MOTION"), 6, motion);
    text.replace(text.find("ct-soft-tissue"), 14, transfer);
    place_.write("s.toml", text);
  }
  /// `brace live s.toml` with these options beside a script that drives it; returns what it said.
  std::string drive(const std::string& options, const std::string& script) {
    place_.write("drive.sh", window_functions + "\"$1\" live s.toml --keep-scale --rate 60 --frames 20000 " +
                                 "--widgets widgets.txt " + options + " >>live.log 2>&1 &\nlive=$!\nshown\n" +
                                 script + "\nxdotool key Escape\nwait $live\n");
    const Outcome outcome = place_.command({"/bin/bash", "drive.sh", BRACE_PROGRAM}, display_);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err << place_.read("live.log");
    const std::string log = place_.read("live.log");
    EXPECT_THAT(log, ::testing::Not(::testing::HasSubstr("never said")));
    EXPECT_THAT(log, ::testing::Not(::testing::HasSubstr("no widget")));
    return log;
  }
  Workplace place_;
  RunOptions display_;
};

}  // namespace brace::test
