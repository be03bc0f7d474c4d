#include "tools/live/stage_panel.hpp"

#include <gtest/gtest.h>
#include <imgui.h>

namespace brace {
namespace {

StageParameter parameter(const char* name, ParameterType type, double low, double high, double value) {
  StageParameter made;
  made.name = name;
  made.type = type;
  made.minimum = low;
  made.maximum = high;
  made.default_value = value;
  return made;
}

PipelineStage cast_stage() {
  PipelineStage cast;
  cast.stage.family = "cast";
  cast.stage.name = "rays_and_light";
  cast.stage.parameters = {parameter("step", ParameterType::floating, 0.0, 10.0, 1.0),
                           parameter("passes", ParameterType::integer, 1.0, 9.0, 2.0),
                           parameter("lit", ParameterType::boolean, 0.0, 1.0, 0.0),
                           parameter("rule", ParameterType::choice, 0.0, 1.0, 0.0)};
  cast.stage.parameters[0].unit = "voxels";
  cast.stage.parameters[3].choices = {"left", "middle"};
  cast.values = {1.0, 2.0, 0.0, 0.0};
  return cast;
}

/// The panel in a window, with a mouse.
class Panel {
 public:
  Panel() {
    pipeline_["cast"] = cast_stage();
    StageInfo other = cast_stage().stage;
    other.name = "another";
    other.parameters.clear();
    stages_ = {cast_stage().stage, other};
    for (int i = 0; i < 3; ++i)
      step();
  }

  /// One frame; what was chosen in it.
  std::optional<Setting> step() {
    ImageRgba8 picture(600, 500);
    overlay_.begin(600, 500, 0.02);
    std::optional<Setting> setting;
    if (overlay_.begin_panel("column", {100, 0, 400, 500}))
      setting = panel_.show(overlay_, pipeline_, stages_, {});
    overlay_.end_panel();
    overlay_.end(picture);
    return setting;
  }

  void move_to(const std::string& widget, double across = 0.5) {
    ASSERT_TRUE(overlay_.places().contains(widget)) << widget << " in\n" << places_text(overlay_.places());
    const WindowRect at = overlay_.places().at(widget);
    ImGui::GetIO().MousePos = ImVec2(static_cast<float>(at.x + across * at.width),
                                     static_cast<float>(at.y) + 0.5f * static_cast<float>(at.height));
    step();
  }
  std::vector<Setting> press(bool down) {
    ImGui::GetIO().MouseDown[0] = down;
    std::vector<Setting> all;
    for (int i = 0; i < 4; ++i)
      if (const auto setting = step()) all.push_back(*setting);
    return all;
  }
  std::vector<Setting> click(const std::string& widget) {
    move_to(widget);
    std::vector<Setting> all = press(true);
    for (const Setting& setting : press(false))
      all.push_back(setting);
    return all;
  }

  Overlay overlay_;

 private:
  StagePanel panel_;
  std::map<std::string, PipelineStage> pipeline_;
  std::vector<StageInfo> stages_;
};

TEST(StagePanel, OffersTheStagesOfAFamilyAndSaysOnceWhichIsChosen) {
  Panel panel;
  EXPECT_TRUE(panel.click("pipeline.cast").empty());
  const std::vector<Setting> chosen = panel.click("pipeline.cast=another");
  ASSERT_EQ(chosen.size(), 1U);
  EXPECT_EQ(chosen[0].key, "pipeline.cast");
  EXPECT_EQ(chosen[0].value, "another");
}

TEST(StagePanel, ChoosesNothingByTheStageThatIsThere) {
  Panel panel;
  panel.click("pipeline.cast");
  EXPECT_TRUE(panel.click("pipeline.cast=rays_and_light").empty());
}

TEST(StagePanel, SetsParametersAsASessionNamesThem) {
  Panel panel;
  panel.click("cast/rays_and_light");  // unfolds
  const std::vector<Setting> lit = panel.click("cast/rays_and_light.lit");
  ASSERT_EQ(lit.size(), 1U);
  EXPECT_EQ(lit[0].key, "stage.cast/rays_and_light.lit");
  EXPECT_EQ(lit[0].value, "true");
  panel.click("cast/rays_and_light.rule");
  const std::vector<Setting> rule = panel.click("cast/rays_and_light.rule=middle");
  ASSERT_EQ(rule.size(), 1U);
  EXPECT_EQ(rule[0].value, "middle");
}

TEST(StagePanel, TakesASlidersValueWhenItIsLetGo) {
  Panel panel;
  panel.click("cast/rays_and_light");
  panel.move_to("cast/rays_and_light.step", 0.2);
  EXPECT_TRUE(panel.press(true).empty());
  panel.move_to("cast/rays_and_light.step", 0.75);
  EXPECT_TRUE(panel.press(true).empty()) << "still held";
  const std::vector<Setting> set = panel.press(false);
  ASSERT_EQ(set.size(), 1U);
  EXPECT_EQ(set[0].key, "stage.cast/rays_and_light.step");
  EXPECT_NEAR(std::stod(set[0].value), 7.5, 0.4);

  panel.move_to("cast/rays_and_light.passes", 0.5);
  panel.press(true);
  const std::vector<Setting> passes = panel.press(false);
  ASSERT_EQ(passes.size(), 1U);
  EXPECT_EQ(passes[0].value, "5") << "a whole number";
}

TEST(StagePanel, SaysWhatAParameterAccepts) {
  const PipelineStage cast = cast_stage();
  EXPECT_EQ(accepted_of(cast.stage.parameters[0]), "voxels, 0 to 10");
  EXPECT_EQ(accepted_of(cast.stage.parameters[1]), "1 to 9");
  EXPECT_EQ(accepted_of(cast.stage.parameters[2]), "true or false");
  EXPECT_EQ(accepted_of(cast.stage.parameters[3]), "left, middle");
  EXPECT_EQ(value_text(cast.stage.parameters[0], 1e-5), "1e-05");
  EXPECT_EQ(value_text(cast.stage.parameters[1], 3.0), "3");
}

}  // namespace
}  // namespace brace
