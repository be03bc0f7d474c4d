#include "runtime/report/trace_events.hpp"

#include <cmath>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "tests/unit/report/made_up_run.hpp"
#include "tests/unit/report/test_folder.hpp"

namespace brace {
namespace {

class TraceEvents : public TestFolder {
 protected:
  nlohmann::json write(const ReportInput& input, std::size_t vsyncs_max = 100'000) {
    write_trace_events(folder_ / "timeline.json", input, vsyncs_max);
    return nlohmann::json::parse(text_of(folder_ / "timeline.json"));
  }
  ReportInput input_of(const MadeUpRun& run, bool with_jobs) {
    ReportInput input = made_up_input();
    input.series.resize(1);
    input.series[0].label = "quote \" and \\";
    input.series[0].records = run.records;
    if (with_jobs) input.series[0].jobs = run.jobs;
    return input;
  }
  static std::size_t count(const nlohmann::json& trace, const std::string& phase, int track) {
    std::size_t n = 0;
    for (const auto& e : trace["traceEvents"]) {
      if (e["ph"] == phase && e.value("tid", 0) == track) ++n;
    }
    return n;
  }
};

TEST_F(TraceEvents, TracksHaveTheirNames) {
  const MadeUpRun run = made_up_run({.vsyncs = 20});
  std::set<std::string> names;
  const nlohmann::json trace = write(input_of(run, true));
  for (const auto& e : trace["traceEvents"]) {
    if (e["name"] == "thread_name") names.insert(e["args"]["name"]);
  }
  EXPECT_EQ(names, (std::set<std::string>{"vsync", "ray casting", "warp", "scan-out", "tracker poses"}));
}

TEST_F(TraceEvents, EveryVsyncJobAndScanOutIsThere) {
  const MadeUpRun run = made_up_run({.vsyncs = 200});
  const nlohmann::json trace = write(input_of(run, true));
  std::size_t shown = 0, casts = 0;
  for (const FrameRecord& r : run.records)
    shown += r.photon_first_row_ns >= 0 ? 1u : 0u;
  for (const JobRecord& j : run.jobs)
    casts += j.kind == JobKind::cast ? 1u : 0u;
  EXPECT_EQ(count(trace, "i", 1), 200u);
  EXPECT_EQ(count(trace, "X", 2), casts);
  EXPECT_EQ(count(trace, "X", 3), run.jobs.size() - casts);
  EXPECT_EQ(count(trace, "X", 4), shown);
}

TEST_F(TraceEvents, WithoutJobsTheFramesShownAreThere) {
  const MadeUpRun run = made_up_run({.vsyncs = 200});
  std::set<std::int64_t> frames;
  for (const FrameRecord& r : run.records) {
    if (r.displayed_frame >= 0) frames.insert(r.displayed_frame);
  }
  EXPECT_EQ(count(write(input_of(run, false)), "X", 2), frames.size());
}

TEST_F(TraceEvents, EveryArrowLeadsFromItsFramesCastingToTheScanOutThatShowsItFirst) {
  const MadeUpRun run = made_up_run({.vsyncs = 100});
  const nlohmann::json trace = write(input_of(run, true));
  std::map<double, std::int64_t> cast_at, shown_at;
  std::map<std::string, std::pair<double, double>> arrows;
  for (const auto& e : trace["traceEvents"]) {
    if (e["ph"] == "X" && e["tid"] == 2) cast_at[e["ts"]] = e["args"]["frame"];
    if (e["ph"] == "X" && e["tid"] == 4) shown_at[e["ts"]] = e["args"]["frame"];
    if (e["ph"] == "s") arrows[e["id"]].first = e["ts"];
    if (e["ph"] == "f") arrows[e["id"]].second = e["ts"];
  }
  ASSERT_GT(arrows.size(), 50u);
  for (const auto& [id, ends] : arrows) {
    ASSERT_TRUE(cast_at.contains(ends.first) && shown_at.contains(ends.second)) << id;
    EXPECT_EQ(cast_at[ends.first], shown_at[ends.second]) << id;
  }
}

TEST_F(TraceEvents, TimesAreExactToTheNanosecond) {
  FrameRecord record;
  record.vsync_ns = 1'234'567'891'234'567;
  const MadeUpRun run{{record}, {}};
  write(input_of(run, false));
  EXPECT_NE(text_of(folder_ / "timeline.json").find("\"ts\":1234567891234.567,"), std::string::npos);
}

TEST_F(TraceEvents, ALongRunIsCutAndSaysSo) {
  const MadeUpRun run = made_up_run({.vsyncs = 200});
  const nlohmann::json trace = write(input_of(run, true), 50);
  EXPECT_EQ(count(trace, "i", 1), 50u);
  EXPECT_LT(count(trace, "X", 2), 80u);
  EXPECT_EQ(trace["otherData"]["vsyncs 1"], "50 of 200");
}

}  // namespace
}  // namespace brace
