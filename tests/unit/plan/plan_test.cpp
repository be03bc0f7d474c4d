// What the planner knows without a device; its decisions are tested through the command
// (tests/cli/plan_test.cpp).
#include <cmath>

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

TransferTable band_table() {
  TransferTable table;
  table.range = {0.0, 255.0};
  for (int i = 0; i < 256; ++i)
    table.entries.push_back({1.0, 1.0, 1.0, i >= 100 && i <= 120 ? 0.01 * (i - 99) : 0.0});
  return table;
}

TEST(VolumeFactsTest, SupportAndStiffnessAreThoseOfTheBandWithinTheData) {
  const VolumeFacts all = volume_facts({band_table()}, {0.25}, {0.0, 255.0}, 0.5);
  EXPECT_EQ(all.occupancy, 0.25);
  EXPECT_EQ(all.visible.min, 99.0) << "interpolation makes it visible beside the first entry";
  EXPECT_EQ(all.visible.max, 121.0);
  EXPECT_NEAR(all.visible_values, 22.0 / 255.0, 1e-12);
  EXPECT_DOUBLE_EQ(all.kappa_dt_min, 0.005);
  EXPECT_DOUBLE_EQ(all.kappa_dt_max, 0.105);
  // Data that ends within the band.
  const VolumeFacts part = volume_facts({band_table()}, {0.5}, {0.0, 109.5}, 1.0);
  EXPECT_EQ(part.visible.max, 109.5);
  EXPECT_NEAR(part.visible_values, 10.5 / 109.5, 1e-12);
  EXPECT_DOUBLE_EQ(part.kappa_dt_max, 0.11) << "the entry that the last value is interpolated to";
  EXPECT_EQ(volume_facts({band_table()}, {1.0}, {110.0, 110.0}, 1.0).visible_values, 1.0) << "of one value";
  const VolumeFacts nothing = volume_facts({band_table()}, {0.0}, {130.0, 255.0}, 1.0);
  EXPECT_EQ(nothing.visible_values, 0.0);
  EXPECT_EQ(nothing.kappa_dt_min, 0.0);
  EXPECT_EQ(nothing.kappa_dt_max, 0.0);
}

TEST(VolumeFactsTest, OfTablesThatFollowEachOtherTheyHoldForAll) {
  TransferTable later = band_table();
  later.entries[200][3] = 3.0;
  const VolumeFacts facts = volume_facts({band_table(), later}, {0.1, 0.3}, {0.0, 255.0}, 1.0);
  EXPECT_DOUBLE_EQ(facts.occupancy, 0.2);
  EXPECT_EQ(facts.visible.max, 201.0);
  EXPECT_EQ(facts.kappa_dt_max, 3.0);
}

TEST(SceneFactsTest, DisparityIsThatOfTheBoundingSphere) {
  SceneFacts facts;
  EXPECT_FALSE(facts.disparity_px()) << "nothing is rendered";
  // Buchacher's example: 32 px at 0.4465 m for a sphere of 1 m.
  facts.eye_distance_m = 0.065;
  facts.pixels_per_tangent = 768.0 / (2.0 * std::tan(55.0 * 3.14159265358979 / 180.0));
  facts.volume_distance_m = 0.44649;
  facts.volume = VolumeFacts{.visible = {}, .bounding_radius_m = 1.0};
  EXPECT_NEAR(*facts.disparity_px(), 32.0, 0.01);
}

TEST(SceneFactsTest, LinesNameLensAndScanOut) {
  const auto line_of = [](const SceneFacts& facts, const std::string& name) {
    for (const FactLine& line : fact_lines(facts))
      if (line.name == name) return line.figure;
    return std::string("no such line");
  };
  const SceneFacts vive = facts_of(session_before("htc-vive", 0.8), 100.0);
  EXPECT_THAT(line_of(vive, "lens, right blue"), HasSubstr("vive: -0.2628, 0.04276, -0.08325"));
  EXPECT_THAT(line_of(vive, "scan-out"), HasSubstr("top_to_bottom"));
  EXPECT_THAT(line_of(vive, "head"), HasSubstr("100.0 deg/s"));
  EXPECT_EQ(line_of(vive, "occupancy"), "no such line");
  EXPECT_THAT(line_of(facts_of(session_before("cardboard-v1", 0.8), 0.0), "lens"), HasSubstr("all channels"));
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
  plan.facts.volume_distance_m = 1.0;
  plan.facts.volume = VolumeFacts{.occupancy = 0.5,
                                  .visible_values = 0.1,
                                  .visible = {1.0, 2.0},
                                  .kappa_dt_min = 0.25,
                                  .kappa_dt_max = 0.5};
  return plan;
}

TEST(PlanText, NamesEveryLineAndTheWayToRunIt) {
  const std::string text = to_text(made_up_plan());
  EXPECT_THAT(text, HasSubstr("skip/octree  left out     +1.000  2 ms with, 1 without"));
  EXPECT_THAT(text, HasSubstr("50.0 % less"));
  EXPECT_THAT(text, HasSubstr("--leave-out skip"));
  EXPECT_THAT(text, HasSubstr("kappa dt             0.25 … 0.5 where visible"));
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
  EXPECT_EQ(json["facts"]["volume"]["kappa_dt_max"], 0.5);
  EXPECT_EQ(json["facts"]["lens"]["left"]["green"].size(), 5u);
  EXPECT_FALSE(json["check"]["passed"].get<bool>());
}

}  // namespace
}  // namespace brace
