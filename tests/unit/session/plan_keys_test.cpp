// [plan]: what a session does without.
#include "runtime/session/plan_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/session_text.hpp"

namespace brace {
namespace {

using test::error_of;
using test::parse;
using test::smallest;
using testing::ElementsAre;
using testing::HasSubstr;
using Mode = Session::Plan::Mode;

TEST(PlanKeys, WhatIsNamedIsTakenOutOfTheSession) {
  const Session session = parse(
      smallest, {{"scene.shading", "phong"}, {"pipeline.warp", "quad"}, {"plan.leave_out", "shading,warp"}});
  EXPECT_EQ(session.scene.shading, "none");
  EXPECT_EQ(session.pipeline.at("warp").stage.id(), "warp/none");
  EXPECT_THAT(session.plan.leave_out, ElementsAre("shading", "warp"));
  EXPECT_EQ(session.plan.mode, Mode::idle);
  EXPECT_FALSE(has_item(session, "warp"));
  const Session again = parse(session.resolved_toml);
  EXPECT_EQ(again.pipeline.at("warp").stage.id(), "warp/none");
}

TEST(PlanKeys, WithoutScanOutCorrectionAWarpTakesThePoseOfTheMiddle) {
  const std::vector<std::pair<std::string, std::string>> by_line = {{"pipeline.warp", "by_line"},
                                                                    {"stage.by_line.scan_out", "lines"}};
  EXPECT_TRUE(has_item(parse(smallest, by_line), "scan_out_correction"));
  auto without = by_line;
  without.emplace_back("plan.leave_out", "scan_out_correction");
  const Session session = parse(smallest, without);
  EXPECT_FALSE(has_item(session, "scan_out_correction"));
  EXPECT_EQ(session.pipeline.at("warp").value("scan_out"), 0.0);
  EXPECT_FALSE(has_item(parse(smallest, {{"pipeline.warp", "none"}}), "scan_out_correction"));
}

TEST(PlanKeys, AnItemThatIsNotThereIsNoError) {
  const Session session =
      parse(smallest, {{"plan.leave_out", "preintegration,early_termination,stereo,rays,skip"}});
  EXPECT_EQ(session.pipeline.at("skip").stage.id(), "skip/none");
}

TEST(PlanKeys, AModeMayStandBesideItems) {
  const Session session = parse(smallest, {{"plan.leave_out", "auto,shading"}, {"plan.keep", "warp"}});
  EXPECT_EQ(session.plan.mode, Mode::automatic);
  EXPECT_THAT(session.plan.leave_out, ElementsAre("shading"));
  EXPECT_TRUE(session.plan.keeps_idle("warp"));
  EXPECT_FALSE(session.plan.keeps_idle("distortion"));
  EXPECT_TRUE(parse(smallest, {{"plan.leave_out", "none"}}).plan.keeps_idle("distortion"));
}

TEST(PlanKeys, WhatIsWrongIsNamedWithWhatIsAccepted) {
  EXPECT_THAT(error_of(smallest, {{"plan.leave_out", "shadin"}}),
              testing::AllOf(HasSubstr("did you mean 'shading'?"), HasSubstr("scan_out_correction")));
  EXPECT_THAT(error_of(smallest, {{"plan.keep", "auto"}}), HasSubstr("plan.keep"));
  EXPECT_THAT(error_of(smallest, {{"plan.leave_out", "auto,none"}}), HasSubstr("two of"));
  EXPECT_THAT(error_of(smallest, {{"plan.leave_out", "warp"}, {"plan.keep", "warp"}}),
              HasSubstr("one of the two"));
}

TEST(PlanKeys, LevelsOfTheAtlasAreTakenOutOneByOne) {
  const auto rays_without = [](const std::string& items) {
    return parse(smallest, {{"pipeline.rays", "mab"}, {"plan.leave_out", items}}).pipeline.at("rays");
  };
  const PipelineStage all = rays_without("idle");
  ASSERT_EQ(all.value("levels"), 4.0);
  // The finest: the second begins in the middle, with its own scale.
  const PipelineStage coarser = rays_without("mab_level_0");
  EXPECT_EQ(coarser.value("levels"), 3.0);
  EXPECT_EQ(coarser.value("scale_0"), all.value("scale_1"));
  EXPECT_EQ(coarser.value("anchor_1"), all.value("anchor_2"));
  // One between: the next coarser begins where it began.
  const PipelineStage between = rays_without("mab_level_1");
  EXPECT_EQ(between.value("scale_1"), all.value("scale_2"));
  EXPECT_EQ(between.value("anchor_1"), all.value("anchor_1"));
  EXPECT_EQ(between.value("anchor_2"), all.value("anchor_3"));
  // The coarsest: the one before it goes on to the edge.
  const PipelineStage finer = rays_without("mab_level_3,mab_level_7");
  EXPECT_EQ(finer.value("levels"), 3.0);
  EXPECT_EQ(finer.value("scale_2"), all.value("scale_2"));
  EXPECT_EQ(finer.value("anchor_2"), all.value("anchor_2"));
  const PipelineStage one = rays_without("mab_level_0,mab_level_1,mab_level_3");
  EXPECT_EQ(one.value("levels"), 1.0);
  EXPECT_EQ(one.value("scale_0"), all.value("scale_2"));
}

TEST(PlanKeys, LeftOutLevelsAreNotLeftOutTwice) {
  const Session session = parse(smallest, {{"pipeline.rays", "mab"}, {"plan.leave_out", "mab_level_0"}});
  EXPECT_EQ(session.plan.mab_scales.size(), 4u);
  EXPECT_TRUE(has_item(session, "mab_level_3"));
  EXPECT_FALSE(has_item(session, "mab_level_4"));
  EXPECT_EQ(parse(session.resolved_toml).pipeline.at("rays").value("levels"), 3.0);
  EXPECT_THAT(error_of(smallest, {{"pipeline.rays", "mab"},
                                  {"plan.leave_out", "mab_level_0,mab_level_1,mab_level_2,mab_level_3"}}),
              HasSubstr("every level of rays/mab"));
  EXPECT_FALSE(has_item(parse(smallest), "mab_level_0"));
}

}  // namespace
}  // namespace brace
