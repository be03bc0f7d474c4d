#include "tools/live/transfer_panel.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <imgui.h>

namespace brace {
namespace {

constexpr ValueRange range{0.0, 100.0};

TransferFunction ramp() {
  TransferFunction tf;
  tf.points = {{10.0, {1, 0, 0, 0.0}}, {50.0, {0, 1, 0, 0.3}}, {90.0, {0, 0, 1, 1.0}}};
  return tf;
}

TEST(TransferEdit, KeepsPointsInTheirOrderAndInTheRange) {
  TransferFunction tf = ramp();
  move_point(tf, 1, 200.0, 0.5, range);
  EXPECT_NEAR(tf.points[1].value, 90.0 - value_gap * 100.0, 1e-12);
  EXPECT_NEAR(opacity_from_kappa(tf.points[1].sample.kappa, 1.0), 0.5, 1e-12);
  move_point(tf, 1, -5.0, -1.0, range);
  EXPECT_NEAR(tf.points[1].value, 10.0 + value_gap * 100.0, 1e-12);
  EXPECT_EQ(tf.points[1].sample.kappa, 0.0);
  move_point(tf, 0, -5.0, 7.0, range);
  EXPECT_EQ(tf.points[0].value, 0.0);
  EXPECT_NEAR(tf.points[0].sample.kappa, opaque_optical_depth, 1e-12);
  EXPECT_NO_THROW(validate(tf));
}

TEST(TransferEdit, AddsPointsOnTheCurve) {
  TransferFunction tf = ramp();
  const TransferSample before = evaluate(tf, 30.0);
  EXPECT_EQ(add_point(tf, 30.0, range), 1U);
  EXPECT_EQ(tf.points.size(), 4U);
  EXPECT_EQ(tf.points[1].sample.kappa, before.kappa);
  for (const double value : {0.0, 20.0, 40.0, 70.0, 100.0})
    EXPECT_NEAR(evaluate(tf, value).kappa, evaluate(ramp(), value).kappa, 1e-12);
  EXPECT_EQ(add_point(tf, 30.000001, range), 1U) << "there is one";
  EXPECT_EQ(tf.points.size(), 4U);
  EXPECT_EQ(add_point(tf, 1e9, range), 4U);
  EXPECT_EQ(tf.points.back().value, 100.0);
  EXPECT_NO_THROW(validate(tf));
}

TEST(TransferEdit, KeepsTheLastPoint) {
  TransferFunction tf = ramp();
  for (int i = 0; i < 5; ++i)
    remove_point(tf, 0);
  ASSERT_EQ(tf.points.size(), 1U);
  EXPECT_EQ(tf.points[0].value, 90.0);
}

VoxelStatistics statistics() {
  VoxelStatistics made;
  made.type = VoxelType::uint8;
  made.range = range;
  made.counts.assign(256, 0);
  made.counts[0] = 1'000'000;  // air
  made.counts[50] = 1000;
  made.counts[80] = 31;
  made.voxels = 1'001'031;
  return made;
}

TEST(TransferEdit, DrawsTheHistogramByItsLogarithmAndLetsAirNotFlattenIt) {
  const std::vector<float> bars = log_bars(statistics(), range, 100);
  ASSERT_EQ(bars.size(), 100U);
  EXPECT_FLOAT_EQ(bars[0], 1.0f);
  EXPECT_FLOAT_EQ(bars[50], 1.0f);
  EXPECT_NEAR(bars[80], std::log(32.0) / std::log(1001.0), 1e-6);
  EXPECT_EQ(bars[60], 0.0f);
  VoxelStatistics constant = statistics();
  std::fill(constant.counts.begin() + 1, constant.counts.end(), 0);
  EXPECT_FLOAT_EQ(log_bars(constant, range, 100)[0], 1.0f);
}

/// The panel in a window, with a mouse, over a function that follows it.
class TransferWindow {
 public:
  TransferWindow() { steps(3); }

  TransferPanel::Change step() {
    ImageRgba8 picture(500, 300);
    overlay_.begin(500, 300, 0.02);
    TransferPanel::Change change;
    if (overlay_.begin_panel("column", {50, 0, 400, 300}))
      change = panel_.show(overlay_, function_, statistics(), range);
    overlay_.end_panel();
    overlay_.end(picture);
    if (change.edited) function_ = *change.edited;
    if (!change.save_as.empty()) saved_ = change.save_as;
    return change;
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i)
      step();
  }
  void mouse(float x, float y) {
    ImGui::GetIO().MousePos = ImVec2(x, y);
    steps(2);
  }
  void button(int index, bool down) {
    ImGui::GetIO().MouseDown[index] = down;
    steps(2);
  }
  WindowRect place(const char* widget) const { return overlay_.places().at(widget); }

  Overlay overlay_;
  TransferPanel panel_{"out.toml"};
  TransferFunction function_ = ramp();
  std::string saved_;
};

TEST(TransferPanel, DragsTheCurvesPoints) {
  TransferWindow window;
  const WindowRect plot = window.place("transfer.plot");
  const std::array<float, 2> at = place_of(window.function_.points[1], plot, range);
  window.mouse(at[0], at[1]);
  window.button(0, true);
  const float goal_x = static_cast<float>(plot.x) + 0.7f * static_cast<float>(plot.width);
  const float goal_y = static_cast<float>(plot.y) + 0.5f * static_cast<float>(plot.height);
  window.mouse(0.5f * (at[0] + goal_x), goal_y);
  window.mouse(goal_x, goal_y);
  window.button(0, false);
  window.mouse(5, 5);
  EXPECT_NEAR(window.function_.points[1].value, 70.0, 1.0);
  EXPECT_NEAR(opacity_from_kappa(window.function_.points[1].sample.kappa, 1.0), 0.25, 0.02);
  EXPECT_EQ(window.function_.points[0].value, 10.0);
}

TEST(TransferPanel, SetsAPointByADoubleClickAndTakesOneByTheRightButton) {
  TransferWindow window;
  const WindowRect plot = window.place("transfer.plot");
  window.mouse(static_cast<float>(plot.x) + 0.3f * static_cast<float>(plot.width),
               static_cast<float>(plot.y) + 20);
  for (int click = 0; click < 2; ++click) {
    window.button(0, true);
    window.button(0, false);
  }
  ASSERT_EQ(window.function_.points.size(), 4U);
  EXPECT_NEAR(window.function_.points[1].value, 30.0, 1.0);
  EXPECT_NEAR(opacity_from_kappa(window.function_.points[1].sample.kappa, 1.0), 25.0 / 36.0, 0.02)
      << "at the mouse, 20 of 120 pixels below the top";
  const std::array<float, 2> last = place_of(window.function_.points[3], plot, range);
  window.mouse(last[0], last[1]);
  window.button(1, true);
  window.button(1, false);
  ASSERT_EQ(window.function_.points.size(), 3U);
  EXPECT_EQ(window.function_.points[2].value, 50.0);
}

TEST(TransferPanel, SavesWhereItSays) {
  TransferWindow window;
  const WindowRect save = window.place("transfer.save");
  window.mouse(static_cast<float>(save.x + 5), static_cast<float>(save.y + 5));
  window.button(0, true);
  EXPECT_EQ(window.saved_, "");
  window.button(0, false);
  EXPECT_EQ(window.saved_, "out.toml");
}

}  // namespace
}  // namespace brace
