// What the planner knows without a device; its decisions are tested through the command
// (tests/cli/plan_test.cpp).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hmd_sim/trace_generators.hpp"
#include "runtime/plan/plan_text.hpp"
#include "runtime/plan/scene_facts.hpp"
#include "runtime/timeline/gpu_time.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

Session session_before(const char* profile, double distance_m) {
  Session session;
  session.device.profile = profile;
  session.device.lens = "profile";
  session.scene.position = "front:" + std::to_string(distance_m);
  session.scene.up = "+y";
  session.scene.front = "+z";
  session.scene.size_m = 0.5;
  return session;
}

HeadTrace spinning(double degrees_per_s) {
  sim::MotionSpec spec;
  spec.motion = sim::parse_motion(degrees_per_s == 0.0 ? "stationary" : "spin");
  spec.degrees_per_s = degrees_per_s;
  spec.seconds = 2.0;
  return {sim::generate_trace(spec), {}, "spin"};
}

SceneFacts facts_of(const Session& session, double degrees_per_s) {
  return scene_facts(session, make_headset(session, BRACE_DATA_DIR), spinning(degrees_per_s));
}

TEST(SceneFactsTest, SpeedAndScanOutFollowTheHead) {
  const Session session = session_before("oculus-dk2", 0.8);
  EXPECT_EQ(facts_of(session, 0.0).head_deg_s, 0.0);
  for (const double speed : {1.0, 100.0, 1000.0}) {
    const SceneFacts facts = facts_of(session, speed);
    EXPECT_NEAR(facts.head_deg_s / speed, 1.0, 1e-3) << speed;
    EXPECT_NEAR(facts.scan_out_px(), facts.head_deg_s * facts.scan_out_ms * 1e-3 * facts.px_per_deg, 1e-9);
  }
  EXPECT_GT(facts_of(session, 10.0).scan_out_ms, 5.0) << "a rolling panel";
}

TEST(SceneFactsTest, OffsetsAreInPixelsOfThePanel) {
  SceneFacts facts;
  facts.px_per_deg = 10.0;
  facts.volume_distance_m = 1.0;
  EXPECT_DOUBLE_EQ(facts.off_px(0.5, 0.0), 5.0);
  EXPECT_NEAR(facts.off_px(0.0, 17.455), 10.0, 0.01);  // a degree at a metre
}

TEST(SceneFactsTest, AHeadInsideTheVolumeLeavesTheDistanceAboveZero) {
  EXPECT_GT(facts_of(session_before("htc-vive", 0.0), 0.0).volume_distance_m, 0.0);
}

TEST(GpuTimeTest, IsPerEyeFrameAndDisplayImage) {
  const auto job = [](JobKind kind, std::int64_t cost_ns, bool ends_frame) {
    JobRecord record;
    record.kind = kind;
    record.end_ns = 1;
    record.cost_ns = cost_ns;
    record.ends_frame = ends_frame;
    return record;
  };
  std::vector<JobRecord> jobs = {job(JobKind::cast, 1'000'000, false), job(JobKind::cast, 3'000'000, true),
                                 job(JobKind::cast, 2'000'000, true),  job(JobKind::update, 500'000, true),
                                 job(JobKind::warp, 250'000, true),    job(JobKind::warp, 750'000, true)};
  jobs.push_back(job(JobKind::warp, 1, true));
  jobs.back().end_ns = -1;  // the run ended before it
  const GpuTime time = gpu_time(jobs);
  EXPECT_DOUBLE_EQ(time.cast_ms, 3.0);
  EXPECT_DOUBLE_EQ(time.update_ms, 0.25);
  EXPECT_DOUBLE_EQ(time.warp_ms, 0.5);
  EXPECT_DOUBLE_EQ(time.frame_ms(), 3.75);
  EXPECT_EQ(gpu_time({}).frame_ms(), 0.0);
}

Plan made_up_plan() {
  Plan plan;
  plan.lines.push_back({"skip", "skip/octree", PlanVerdict::left_out, "2 ms with, 1 without", 1.0});
  plan.lines.push_back({"warp", "warp/quad", PlanVerdict::kept, "off by 3 px", {}});
  plan.leave_out = {"skip"};
  plan.given_ms = 2.0;
  plan.planned_ms = 1.0;
  plan.cost = "model:x";
  return plan;
}

TEST(PlanText, NamesEveryLineAndTheWayToRunIt) {
  const std::string text = to_text(made_up_plan());
  EXPECT_THAT(text, HasSubstr("skip/octree  left out     +1.000  2 ms with, 1 without"));
  EXPECT_THAT(text, HasSubstr("50.0 % less"));
  EXPECT_THAT(text, HasSubstr("--leave-out skip"));
  EXPECT_EQ(made_up_plan().reasons().size(), 1u);
}

TEST(PlanText, AWrongPredictionAndAWorsePictureFail) {
  PlanCheck check{2.0, 1.0, 0.01, 0.01, 0.5};
  EXPECT_TRUE(check.passed());
  EXPECT_THAT(to_text(made_up_plan(), check), HasSubstr(": right"));
  check.planned_ms = 1.1;
  EXPECT_FALSE(check.saving_as_predicted());
  EXPECT_THAT(to_text(made_up_plan(), check), HasSubstr("WRONG"));
  check = {2.0, 1.0, 0.01, 0.013, 0.5};
  EXPECT_FALSE(check.passed());
  EXPECT_THAT(to_text(made_up_plan(), check), HasSubstr("WORSE"));
  const auto json = nlohmann::json::parse(to_json(made_up_plan(), &check));
  EXPECT_EQ(json["items"][0]["verdict"], "left out");
  EXPECT_FALSE(json["check"]["passed"].get<bool>());
}

}  // namespace
}  // namespace brace
