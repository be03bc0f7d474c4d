// From session to PNG: a still head, an ideal tracker, no lens, no warp, an opaque box. Where the box must be
// seen follows from the pinhole formula; nothing of the renderer is used to work it out.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "base/image.hpp"
#include "hmd_sim/device_profile.hpp"
#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;

constexpr double kDistance_m = 0.8;
constexpr double kHalf_m = 0.1;  // the solid half of a volume of 0.4 m

const std::string session = R"([device]
profile = "htc-vive"
resolution_scale = 0.2
lens = "none"
tracker = "ideal"
[trace]
neck = { motion = "still", seconds = 0.3 }
[scene]
volume = "generator:solid_box:64"
transfer_function = "opaque.toml"
size_m = 0.4
position = "front:0.8"
[pipeline]
warp = "none"
[output]
images = "list:5"
error = "every:1"
[run]
frames = 8
)";

const std::string opaque_above_half = R"(name = "opaque"
domain = "fraction"
points = [
  { value = 0.0, r = 1.0, g = 1.0, b = 1.0, opacity = 0.0 },
  { value = 0.499, r = 1.0, g = 1.0, b = 1.0, opacity = 0.0 },
  { value = 0.501, r = 1.0, g = 1.0, b = 1.0, opacity = 0.999 },
  { value = 1.0, r = 1.0, g = 1.0, b = 1.0, opacity = 0.999 },
]
)";

struct Edges {  // in pixels from the left and top border
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;
};

Edges lit_part(const ImageRgba8& picture) {
  Edges edges{1e9, -1e9, 1e9, -1e9};
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      if (picture.at(x, y).r < 128) continue;
      edges.left = std::min(edges.left, static_cast<double>(x));
      edges.right = std::max(edges.right, x + 1.0);
      edges.top = std::min(edges.top, static_cast<double>(y));
      edges.bottom = std::max(edges.bottom, y + 1.0);
    }
  }
  return edges;
}

/// The box's front face through a pinhole: it hides the faces behind it, the eye being within its width.
Edges expected_part(const sim::EyeProfile& eye, const ImageRgba8& picture) {
  const auto seen = [&](double x, double y) {
    const glm::dvec3 in_eye = transform_point(inverse(eye.head_from_eye), {x, y, -(kDistance_m - kHalf_m)});
    const double across = in_eye.x / -in_eye.z;
    const double up = in_eye.y / -in_eye.z;
    return std::pair((across - eye.fov.left) / (eye.fov.right - eye.fov.left) * picture.width_px,
                     (eye.fov.top - up) / (eye.fov.top - eye.fov.bottom) * picture.height_px);
  };
  const auto [left, top] = seen(-kHalf_m, kHalf_m);
  const auto [right, bottom] = seen(kHalf_m, -kHalf_m);
  return {left, right, top, bottom};
}

/// The values of a column of frames.csv, in the order of vsyncs.
std::vector<std::string> column(const std::string& csv, const std::string& name) {
  const auto cells = [](const std::string& line) {
    std::vector<std::string> all;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');)
      all.push_back(cell);
    return all;
  };
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> names = cells(line);
  const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  EXPECT_LT(at, names.size()) << name;
  std::vector<std::string> values;
  while (std::getline(lines, line))
    values.push_back(cells(line).at(at));
  return values;
}

class CliPicture : public testing::Test {
 protected:
  void SetUp() override {
    place_.write("s.toml", session);
    place_.write("opaque.toml", opaque_above_half);
  }
  void run(const std::string& out, const std::string& setting) {
    const Outcome outcome = place_.brace({"run", "s.toml", "--out", out, "--set", setting});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  ImageRgba8 picture(const std::string& out, sim::Eye eye) const {
    return read_png(place_ / (out + "/images/000005_" + (eye == sim::Eye::left ? "left" : "right") + ".png"));
  }
  const sim::DeviceProfile profile_ =
      sim::find_device_profile(std::filesystem::path(BRACE_DATA_DIR) / "devices", "htc-vive");
  Workplace place_;
};

TEST_F(CliPicture, TheBoxIsSeenWhereThePinholeFormulaPutsIt) {
  run("a", "pipeline.warp=none");
  std::array<Edges, 2> seen, expected;
  for (const sim::Eye eye : sim::all_eyes) {
    const ImageRgba8 shown = picture("a", eye);
    ASSERT_EQ(shown.width_px, std::lround(0.2 * profile_.panel_width_px));
    ASSERT_EQ(shown.height_px, std::lround(0.2 * profile_.panel_height_px));
    const auto i = static_cast<std::size_t>(eye);
    seen[i] = lit_part(shown);
    expected[i] = expected_part(profile_.eye(eye), shown);
    EXPECT_NEAR(seen[i].left, expected[i].left, 1.0) << i;
    EXPECT_NEAR(seen[i].right, expected[i].right, 1.0) << i;
    EXPECT_NEAR(seen[i].top, expected[i].top, 1.0) << i;
    EXPECT_NEAR(seen[i].bottom, expected[i].bottom, 1.0) << i;
  }
  // The disparity: the left eye sees the box further to the right by IPD over distance.
  const auto middle = [](const Edges& e) { return 0.5 * (e.left + e.right); };
  const sim::FovTangents& left = profile_.eyes[0].fov;
  const sim::FovTangents& right = profile_.eyes[1].fov;
  const double px_per_tan = 0.2 * profile_.panel_width_px / (left.right - left.left);
  const double own_centres = (right.left - left.left) * px_per_tan;  // the eyes' fields are mirror images
  const double disparity = profile_.ipd_m() / (kDistance_m - kHalf_m) * px_per_tan;
  EXPECT_NEAR(middle(seen[0]) - middle(seen[1]), disparity + own_centres, 1.0);
  EXPECT_GT(disparity, 5.0);  // else the line above says nothing
}

TEST_F(CliPicture, AStillHeadHasNoImageErrorAtAll) {
  run("a", "pipeline.warp=none");
  const std::string csv = place_.read("a/frames.csv");
  const std::vector<std::string> shown = column(csv, "displayed_frame");
  int compared = 0;
  for (const char* name : {"dssim_left", "dssim_right"}) {
    const std::vector<std::string> dssim = column(csv, name);
    for (std::size_t k = 0; k < dssim.size(); ++k) {
      if (shown[k].empty()) continue;
      EXPECT_EQ(dssim[k], "0") << name << " at vsync " << k;
      ++compared;
    }
  }
  EXPECT_GE(compared, 12);
}

TEST_F(CliPicture, WithoutAMotionToCorrectTheWarpChangesNothing) {
  run("a", "pipeline.warp=none");
  run("b", "pipeline.warp=quad");
  for (const sim::Eye eye : sim::all_eyes) {
    const ImageRgba8 plain = picture("a", eye);
    const ImageRgba8 warped = picture("b", eye);
    int worst = 0;
    for (std::size_t i = 0; i < plain.pixels.size(); ++i)
      worst = std::max(worst, std::abs(plain.pixels[i].r - warped.pixels[i].r));
    EXPECT_LE(worst, 1);
  }
}

TEST_F(CliPicture, ALensMovesWhatTheEyeSeesOnThePanel) {
  run("a", "device.lens=none");
  run("b", "device.lens=profile");
  EXPECT_NE(picture("a", sim::Eye::left).pixels, picture("b", sim::Eye::left).pixels);
}

}  // namespace
}  // namespace brace
