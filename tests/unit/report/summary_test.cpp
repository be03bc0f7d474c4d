#include "runtime/report/summary.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/report/made_up_run.hpp"

namespace brace {
namespace {

using Json = nlohmann::ordered_json;

ReportInput input_of(const MadeUpRun& run) {
  ReportInput input = made_up_input();
  input.series.resize(1);
  input.series[0].pipeline = {{"cast", "cast/dvr"}, {"warp", "warp/quad"}};
  input.series[0].left_out = {{"skip/none", "nothing to skip"}};
  input.series[0].records = run.records;
  input.series[0].jobs = run.jobs;
  return input;
}

TEST(Summary, HasTheKeysOfTheContract) {
  const MadeUpRun run = made_up_run({});
  const Json json = Json::parse(summary_json(input_of(run)));
  for (const char* key : {"device", "trace", "pipeline", "clock", "deterministic", "vsyncs", "missed_vsyncs",
                          "missed_ratio", "longest_stale_run", "mtp_ms", "frame_age_ms", "fps_avg",
                          "fps_1pct_low", "dssim", "left_out", "host"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  for (const char* kind : {"rotation", "translation"}) {
    for (const char* key : {"p50", "p95", "p99", "max"})
      EXPECT_TRUE(json["mtp_ms"][kind][key].is_number()) << key;
  }
  for (const char* key : {"mean", "p95", "max"})
    EXPECT_TRUE(json["dssim"][key].is_number()) << key;
  for (const char* key : {"wall_s", "cpu_s", "peak_rss_bytes"})
    EXPECT_TRUE(json["host"][key].is_number()) << key;
  EXPECT_EQ(json["left_out"][0]["stage"], "skip/none");
  EXPECT_EQ(json["left_out"][0]["reason"], "nothing to skip");
  EXPECT_EQ(json["vsyncs"], 900);
  EXPECT_EQ(json["pipeline"]["warp"], "warp/quad");
}

TEST(Summary, FiguresAreThoseOfTheRecords) {
  FrameRecord record;
  record.displayed_frame = 0;
  std::vector<FrameRecord> records;
  for (int k = 0; k < 4; ++k) {
    record.vsync_index = k;
    record.mtp_rotation_ns = 10'000'000 * (k + 1);
    record.mtp_translation_ns = 30'000'000;
    record.dssim_left = 0.1 * (k + 1);
    record.dssim_right = 0.1 * (k + 5);
    record.missed = k == 3;
    record.stale_run = record.missed ? 1 : 0;
    records.push_back(record);
  }
  ReportInput input = made_up_input();
  input.series.resize(1);
  input.series[0].records = records;
  const Json json = Json::parse(summary_json(input));
  EXPECT_EQ(json["mtp_ms"]["rotation"]["p50"], 20.0);
  EXPECT_EQ(json["mtp_ms"]["rotation"]["max"], 40.0);
  EXPECT_EQ(json["mtp_ms"]["translation"]["p99"], 30.0);
  EXPECT_NEAR(json["dssim"]["mean"], 0.45, 1e-15);
  EXPECT_NEAR(json["dssim"]["left"]["mean"], 0.25, 1e-15);
  EXPECT_NEAR(json["dssim"]["right"]["max"], 0.8, 1e-15);
  EXPECT_EQ(json["missed_vsyncs"], 1);
  EXPECT_EQ(json["missed_ratio"], 0.25);
}

TEST(Summary, OnlyHostDiffersBetweenEqualRuns) {
  const MadeUpRun run = made_up_run({});
  const ReportInput first = input_of(run);
  ReportInput second = first;
  second.host = {1.0, 2.0, 3, {{"gpu", "another"}}};
  const std::string a = summary_json(first), b = summary_json(second);
  EXPECT_NE(a, b);
  EXPECT_EQ(a.substr(0, a.find("\"host\"")), b.substr(0, b.find("\"host\"")));
  EXPECT_EQ(Json::parse(a).items().begin().key(), "format");
}

TEST(Summary, FiguresThatDoNotExistAreNull) {
  const std::vector<FrameRecord> startup(3);
  ReportInput input = made_up_input();
  input.series.resize(1);
  input.series[0].records = startup;
  const Json json = Json::parse(summary_json(input));
  EXPECT_TRUE(json["mtp_ms"]["rotation"]["p50"].is_null());
  EXPECT_TRUE(json["frame_age_ms"]["max"].is_null());
  EXPECT_EQ(json["missed_ratio"], 0.0);
}

TEST(Summary, WithoutPicturesDssimIsNullAndInfinityIsSpelledOut) {
  MadeUpRun run = made_up_run({.vsyncs = 30});
  for (FrameRecord& r : run.records)
    r.dssim_left = r.dssim_right = std::numeric_limits<double>::quiet_NaN();
  ReportInput input = input_of(run);
  input.host.wall_s = std::numeric_limits<double>::infinity();
  const Json json = Json::parse(summary_json(input));
  EXPECT_TRUE(json["dssim"]["mean"].is_null());
  EXPECT_EQ(json["dssim"]["count"], 0);
  EXPECT_EQ(json["host"]["wall_s"], "inf");
}

TEST(Summary, SeveralSeriesHaveTheirOwnFiguresAndTheFirstStandsAtTheTop) {
  const MadeUpRun none = made_up_run({.vsyncs = 50}), quad = made_up_run({.vsyncs = 60});
  ReportInput input = input_of(none);
  input.series.push_back(input.series[0]);
  input.series[0].label = "none";
  input.series[1].label = "quad";
  input.series[1].records = quad.records;
  const Json json = Json::parse(summary_json(input));
  EXPECT_EQ(json["vsyncs"], 50);
  ASSERT_EQ(json["series"].size(), 2u);
  EXPECT_EQ(json["series"][1]["label"], "quad");
  EXPECT_EQ(json["series"][1]["vsyncs"], 60);
}

TEST(Summary, FiguresOfALongRunStandBeforeThoseOfTheRecordsKept) {
  const MadeUpRun run = made_up_run({.vsyncs = 50});
  ReportInput input = input_of(run);
  PacingFigures whole = pacing_figures(run.records);
  whole.vsyncs = 7'776'000;
  input.series[0].figures = whole;
  EXPECT_EQ(Json::parse(summary_json(input))["vsyncs"], 7'776'000);
}

}  // namespace
}  // namespace brace
