// Warps that go by the lines of the scan-out, against ideal pictures that do.
#include <numeric>

#include <gtest/gtest.h>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;

// A head that turns by up to 310 degrees per second before a panel that takes a period from top to bottom.
const std::string session = R"([device]
profile = "htc-vive"
resolution_scale = 0.16
tracker = "ideal"
[trace]
neck = { motion = "rotation", degrees = 120, seconds = 0.6 }
[scene]
volume = "generator:marschner_lobb:32"
transfer_function = "ct-bone"
size_m = 0.8
position = "front:0.9"
[clock]
queue = "dual"
cost = "scripted"
script = [{ from_s = 0, cast_ms = 5, warp_ms = 1 }]
[pipeline]
predict = "constant_acceleration"
[output]
images = "none"
error = "list:14"
ideal_pose = "lines"
[run]
frames = 15
)";

double error_of(const Workplace& place, const std::string& warp, const std::string& scan_out) {
  const std::string name = warp + "-" + scan_out;
  const Outcome outcome =
      run_session(place, session, name, {"pipeline.warp=" + warp, "stage." + warp + ".scan_out=" + scan_out});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<double> errors = test::csv_column(place.read(name + "/frames.csv"), "dssim_left");
  return std::accumulate(errors.begin(), errors.end(), 0.0);
}

TEST(CliScanOut, WarpsByLineComeNearerToWhatARollingPanelShouldShow) {
  const Workplace place;
  for (const char* warp : {"quad", "volumetric"}) {
    const double at_once = error_of(place, warp, "middle"), by_line = error_of(place, warp, "lines");
    EXPECT_GT(at_once, 1e-4) << warp;
    // What is left is the resampling that a sheared picture takes.
    EXPECT_LT(by_line, 0.5 * at_once) << warp;
  }
}

}  // namespace
}  // namespace brace
