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

}  // namespace
}  // namespace brace
