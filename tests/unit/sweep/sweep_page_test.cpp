#include "runtime/sweep/sweep_page.hpp"

#include <fstream>
#include <iterator>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"

namespace brace {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

SweepFile sweep_of(const std::string& more) {
  std::string text = "session = 's.toml'\n";
  text += more;
  text +=
      "[grid]\npipeline.skip = ['none', 'block']\nstage.dvr.step_voxels = [0.5, 1.0, 2.0]\n"
      "pipeline.warp = ['none', 'quad']\n";
  return parse_sweep(text, "sweep.toml");
}

TEST(SweepKnob, IsTheLastKeyOfNumbersUnlessTheFileNamesOne) {
  EXPECT_EQ(knob_of(sweep_of("")), "stage.dvr.step_voxels");
  EXPECT_EQ(knob_of(sweep_of("knob = 'pipeline.skip'\n")), "pipeline.skip");
  EXPECT_EQ(knob_of(parse_sweep("session = 's.toml'\n[grid]\npipeline.warp = ['a', 'b']\n", "x.toml")), "");
  try {
    (void)sweep_of("knob = 'run.frames'\n");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
    EXPECT_THAT(e.what(), HasSubstr("'knob' wants one of the keys that vary; accepted: pipeline.skip"));
  }
}

class SweepPage : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / "brace-sweep-page";
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    for (const char* name : {"head.html", "report.css", "chart.min.js", "charts.js", "sweep.js"})
      std::ofstream(folder_ / name) << "";
    std::ofstream(folder_ / "sweep.html") << "{{data}}";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  nlohmann::json data(const SweepFile& sweep, const std::vector<SweepRow>& rows) const {
    write_sweep_page(folder_ / "out.html", sweep, rows, "1.0", folder_);
    std::ifstream in(folder_ / "out.html");
    return nlohmann::json::parse(std::string{std::istreambuf_iterator<char>(in), {}});
  }
  static SweepRow row(std::int64_t point, std::int64_t repeat, const std::map<std::string, double>& figures) {
    SweepRow made{{point, repeat, 1}, "done", "", {}};
    for (const std::string& name : sweep_figure_names()) {
      const auto found = figures.find(name);
      made.figures.push_back(found == figures.end() ? std::nullopt : std::optional(found->second));
    }
    return made;
  }
  std::filesystem::path folder_;
};

TEST_F(SweepPage, HasCurvesByMethodMediansAndWhatIsReached) {
  const SweepFile sweep = parse_sweep(
      "session = 's.toml'\nrepeat = 3\n[grid]\npipeline.skip = ['none', 'block']\n"
      "stage.dvr.step_voxels = [1, 2]\n",
      "sweep.toml");
  std::vector<SweepRow> rows;
  const auto add = [&](std::int64_t point, double cast_ms, double dssim) {
    for (std::int64_t repeat = 1; repeat <= 3; ++repeat)
      rows.push_back(row(point, repeat,
                         {{"cast_ms_p50", cast_ms * static_cast<double>(repeat)},
                          {"cast_ms_p99", cast_ms * 2},
                          {"dssim_mean", dssim}}));
  };
  add(1, 5.0, 0.001);
  add(2, 3.0, 0.2);
  add(3, 2.0, 0.02);
  const std::vector<std::optional<double>> none(sweep_figure_names().size());
  rows.push_back({{4, 1, 1}, "crashed", "signal 11", none});
  const nlohmann::json page = data(sweep, rows);
  EXPECT_EQ(page["knob"], "stage.dvr.step_voxels");
  EXPECT_THAT(page["methods"], ElementsAre("skip none", "skip block"));
  EXPECT_EQ(page["points"][0]["figures"]["cast_ms_p50"], 10.0) << "the median of 5, 10 and 15";
  EXPECT_EQ(page["points"][0]["knob"], "1");
  EXPECT_EQ(page["points"][1]["method"], 0);
  EXPECT_EQ(page["points"][2]["method"], 1);
  EXPECT_EQ(page["points"][3]["status"], "crashed");
  EXPECT_TRUE(page["points"][3]["figures"]["dssim_mean"].is_null());
  const nlohmann::json& pair = page["pairs"]["cast_ms_p50|dssim_mean"];
  EXPECT_THAT(pair["front"], ElementsAre(0, 2));
  EXPECT_EQ(pair["reach"][0], 10.0);
  EXPECT_TRUE(pair["reach"][1].is_null()) << "not reached";
  EXPECT_EQ(page["best_at_90_hz"][0]["knob"], "1") << "10 ms fit into a period";
}

TEST_F(SweepPage, SavesOnTheSecondEyeWhatTwoPassesWithTheSameSettingsTakeMore) {
  const SweepFile sweep = parse_sweep(
      "session = 's.toml'\n[grid]\npipeline.stereo = ['layers', 'two_pass']\n"
      "scene.shading_samples = [4, 64]\n",
      "sweep.toml");
  const auto cast = [&](std::int64_t point, double ms) { return row(point, 1, {{"cast_ms_mean", ms}}); };
  // Two passes: 4 and 20 ms, so an eye takes 2 and 10.
  const nlohmann::json page = data(sweep, {cast(1, 5.0), cast(2, 12.0), cast(3, 4.0), cast(4, 20.0)});
  const auto figure = [&](std::size_t point, const char* name) {
    return page["points"][point]["figures"][name];
  };
  EXPECT_DOUBLE_EQ(figure(0, "second_eye_ms"), 3.0);
  EXPECT_DOUBLE_EQ(figure(0, "second_eye_saved"), -0.5);
  EXPECT_DOUBLE_EQ(figure(1, "second_eye_ms"), 2.0);
  EXPECT_DOUBLE_EQ(figure(1, "second_eye_saved"), 0.8);
  EXPECT_TRUE(figure(2, "second_eye_saved").is_null());
  EXPECT_EQ(page["along"][0]["figure"], "second_eye_saved");
}

TEST_F(SweepPage, NothingRunYetIsAPageToo) {
  const nlohmann::json page = data(sweep_of(""), {});
  EXPECT_EQ(page["points"].size(), 12U);
  EXPECT_TRUE(page["pairs"]["samples|dssim_max"]["front"].empty());
}

}  // namespace
}  // namespace brace
