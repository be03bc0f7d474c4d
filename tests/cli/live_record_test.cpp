// brace live: what it records, and that nothing of it is lost with the window.
#include <cmath>
#include <filesystem>

#include "hmd_sim/trace_io.hpp"
#include "tests/cli/live_fixture.hpp"

namespace brace {
namespace {

using Live = test::Live;
using test::differing_pixels;
using test::Outcome;
using test::replayed_eyes;
using ::testing::HasSubstr;

/// Where in its run a recording begins: it says so itself.
SimTime recorded_from(const std::string& trace) {
  const std::string before = "session s, from ";
  const std::size_t at = trace.find(before);
  EXPECT_NE(at, std::string::npos) << trace.substr(0, 300);
  return SimTime(from_s(std::stod(trace.substr(at + before.size()))));
}

TEST_F(Live, RecordsATraceThatReplaysToTheSamePoses) {
  // A recorded head, at eight pictures a second: far fewer than it has poses.
  const std::string text = test::live_session_on("aframe_tracked_90hz");
  place_.write("s.toml", text);
  const Outcome live = place_.brace({"live", "s.toml", "--set", "trace.start_s=3", "--rate", "8", "--frames",
                                     "9", "--record", "head.trace"},
                                    display_);
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_THAT(live.err, HasSubstr(" poses in head.trace"));
  const sim::PoseTrace recorded = sim::read_trace(place_ / "head.trace").trace;
  const SimTime from = recorded_from(place_.read("head.trace"));
  EXPECT_EQ(recorded.begin_time(), SimTime());

  // Both replays of the same second, at the photon time of each vsync.
  const auto replay = [&](const std::string& name, const std::vector<std::string>& settings) {
    return test::run_session(place_, text, name, settings);
  };
  const std::string begin = fmt::format("trace.start_s={:.9f}", 3.0 + to_s(from - SimTime()));
  ASSERT_EQ(replay("first", {"run.frames=60", begin, "output.images=list:5,40"}).exit_code, 0);
  const Outcome again =
      replay("again", {"run.frames=60", "trace.file=head.trace", "output.images=list:5,40"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const std::string frames = place_.read("again/frames.csv");
  const sim::PoseTrace original =
      sim::read_trace(std::filesystem::path(BRACE_DATA_DIR) / "traces/aframe_tracked_90hz.trace").trace;
  const SimTime offset = original.begin_time() + from_s(3.0) + (from - SimTime());
  const std::vector<double> photon_ns = test::csv_column(frames, "photon_mid_ns");
  ASSERT_EQ(photon_ns.size(), 60U);
  for (const double valid : test::csv_column(frames, "pose_valid"))
    EXPECT_EQ(valid, 1.0) << "no gaps";
  double turned_rad = 0.0;
  for (const double ns : photon_ns) {
    const SimDuration in{std::llround(ns)};
    const Pose a = original.at(offset + in, sim::Interpolation::hermite),
               b = recorded.at(SimTime(in), sim::Interpolation::hermite);
    EXPECT_LT(angle_between_rad(a.orientation, b.orientation), 2e-4) << in.count();
    EXPECT_LT(glm::distance(a.position, b.position), 5e-5) << in.count();
    turned_rad = std::max(turned_rad,
                          angle_between_rad(a.orientation, recorded.poses()[0].world_from_head.orientation));
  }
  EXPECT_GT(turned_rad, 0.05) << "there is something to replay";
  for (const int vsync : {5, 40})
    EXPECT_LT(differing_pixels(replayed_eyes(place_, "first", vsync), replayed_eyes(place_, "again", vsync)),
              5);
}

TEST_F(Live, KeepsItsRecordingWhenTheWindowIsTakenAway) {
  write_session("rotation");
  display_.environment["BRACE_VALIDATION"] = "1";
  // The window alone, and all that this program has of the X server.
  for (const char* taking : {"windowclose", "windowkill"}) {
    place_.write("drive.sh", test::window_functions + R"sh(
"$1" live s.toml --keep-scale --record $2.trace >live.log 2>&1 &
live=$!
shown; sleep 0.3
xdotool $2 $(xdotool search --name ' fps' | head -1)
wait $live
)sh");
    const Outcome outcome = place_.command({"/bin/bash", "drive.sh", BRACE_PROGRAM, taking}, display_);
    const std::string log = place_.read("live.log");
    EXPECT_EQ(outcome.exit_code, 3) << taking << log;
    EXPECT_THAT(log, ::testing::AnyOf(HasSubstr("taken away by another program"),
                                      HasSubstr("the X server has gone")));
    EXPECT_THAT(log, ::testing::Not(HasSubstr("validation")));
    EXPECT_GT(sim::read_trace(place_ / (std::string(taking) + ".trace")).trace.poses().size(), 10U) << log;
  }
}

}  // namespace
}  // namespace brace
