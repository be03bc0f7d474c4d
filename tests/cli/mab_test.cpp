// rays/mab through the command: its pictures beside those of a ray per pixel, and load control that reaches
// them.
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/image.hpp"
#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;
using ::testing::HasSubstr;

const std::string session = R"([device]
profile = "htc-vive"
resolution_scale = 0.06
tracker = "ideal"
[trace]
neck = { motion = "still" }
[scene]
volume = "generator:fractal_vessels:24"
transfer_function = "ct-soft-tissue"
size_m = 0.5
position = "front:0.7"
[clock]
cost = "model:gtx-1080"
[pipeline]
warp = "none"
[output]
images = "list:4"
error = "list:4"
[run]
frames = 6
)";

class Mab : public ::testing::Test {
 protected:
  void run(const std::string& name, std::vector<std::string> settings,
           const std::vector<std::string>& more = {}) {
    const Outcome outcome = try_run(name, std::move(settings), more);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  Outcome try_run(const std::string& name, std::vector<std::string> settings,
                  const std::vector<std::string>& more = {}) {
    return test::run_session(place_, session, name, settings, more);
  }
  void expect_equal_pictures(const std::string& a, const std::string& b) {
    for (const char* eye : {"left", "right"}) {
      const std::string file = std::string("/images/000004_") + eye + ".png";
      EXPECT_TRUE(place_.read(a + file) == place_.read(b + file)) << a << " and " << b << ", " << eye;
    }
  }
  /// Rays of each cast, in order.
  std::vector<double> rays(const std::string& name) {
    std::vector<double> counts = test::csv_column(place_.read(name + "/costs.csv"), "rays");
    std::erase(counts, 0.0);  // other jobs
    return counts;
  }
  double dssim(const std::string& name) {
    return nlohmann::json::parse(place_.read(name + "/summary.json"))["dssim"]["mean"];
  }
  Workplace place_;
};

TEST_F(Mab, OneLevelAtScaleOneIsARayPerPixelBitForBit) {
  const std::vector<std::string> one = {"pipeline.rays=mab", "stage.mab.levels=1", "stage.mab.scale_0=1.0"};
  run("full", {});
  for (const auto& [filter, scheme] :
       {std::pair<std::string, std::string>{"linear", "compact"}, {"catmull_rom", "discard"}}) {
    std::vector<std::string> settings = one;
    settings.insert(settings.end(), {"stage.mab.filter=" + filter, "stage.mab.scheme=" + scheme});
    run(filter, settings);
    expect_equal_pictures("full", filter);
    EXPECT_EQ(rays("full"), rays(filter));
  }
}

TEST_F(Mab, BothSchemesCastTheSameFewerRays) {
  run("full", {});
  run("compact", {"pipeline.rays=mab", "stage.mab.map=eccentricity"});
  run("discard", {"pipeline.rays=mab", "stage.mab.map=eccentricity", "stage.mab.scheme=discard"});
  expect_equal_pictures("compact", "discard");
  EXPECT_EQ(rays("compact"), rays("discard"));
  EXPECT_LT(rays("compact").front(), 0.75 * rays("full").front());
}

TEST_F(Mab, ErrorIsAgainstARayPerPixelAndGrowsAsRaysFall) {
  run("full", {});
  run("fine", {"pipeline.rays=mab"});
  run("coarse",
      {"pipeline.rays=mab", "stage.mab.anchor_1=0.0", "stage.mab.anchor_2=0.05", "stage.mab.anchor_3=0.1"});
  EXPECT_EQ(dssim("full"), 0.0);
  EXPECT_GT(dssim("fine"), 0.0);
  EXPECT_GT(dssim("coarse"), 2.0 * dssim("fine"));
  EXPECT_LT(dssim("coarse"), 0.2) << "a coarse picture, not a wrong one";
}

TEST_F(Mab, EveryCastAndSkipStageWorksFromTheOutside) {
  run("plain", {"pipeline.rays=mab"});
  for (const std::string skip : {"distance_map", "octree"}) {
    run(skip, {"pipeline.rays=mab", "pipeline.skip=" + skip});
    expect_equal_pictures("plain", skip);
  }
  const std::string examples = std::string(BRACE_SOURCE_DIR) + "/plugins/examples";
  for (const std::string cast : {"mip", "isosurface"}) {
    const std::vector<std::string> path = {"--plugin-path", examples};
    run(cast + "-full", {"pipeline.cast=" + cast}, path);
    run(cast, {"pipeline.rays=mab", "pipeline.cast=" + cast}, path);
    run(cast + "-one",
        {"pipeline.rays=mab", "pipeline.cast=" + cast, "stage.mab.levels=1", "stage.mab.scale_0=1.0"}, path);
    expect_equal_pictures(cast + "-full", cast + "-one");
    EXPECT_GT(dssim(cast), 0.0);
    EXPECT_LT(dssim(cast), 0.1);
  }
}

TEST_F(Mab, StereoByNovelViewWorksOnAnAtlas) {
  const std::vector<std::string> novel = {"pipeline.stereo=novel_view", "scene.size_m=0.8"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> settings = novel;
    settings.insert(settings.end(), more.begin(), more.end());
    return settings;
  };
  run("twice", {"scene.size_m=0.8"});
  run("pixels", with({}));
  // An atlas of a ray per pixel is no atlas: the same rays, the same layers, the same views.
  run("one", with({"pipeline.rays=mab", "stage.mab.levels=1", "stage.mab.scale_0=1.0"}));
  EXPECT_NEAR(rays("one").front(), rays("pixels").front(), 0.01 * rays("pixels").front());
  EXPECT_NEAR(dssim("one"), dssim("pixels"), 0.002);
  run("atlas", with({"pipeline.rays=mab"}));
  EXPECT_LT(rays("atlas").front(), 0.95 * rays("pixels").front());
  EXPECT_LT(rays("atlas").front(), 0.7 * rays("twice").front());
  EXPECT_LT(dssim("atlas"), dssim("pixels") + 0.03);
  // Load control reaches it.
  run("controlled", with({"pipeline.rays=mab", "stage.mab.ray_share=0.4"}));
  EXPECT_LT(rays("controlled").front(), 0.75 * rays("atlas").front());
}

TEST_F(Mab, EqualRaysForDifferentMaps) {
  const auto rays_of = [&](const std::string& map, const std::string& share) {
    const std::string name = map + share;
    run(name, {"pipeline.rays=mab", "stage.mab.scale_0=1.0", "stage.mab.map=" + map,
               "stage.mab.ray_share=" + share, "stage.mab.anchor_1=1", "stage.mab.anchor_2=1",
               "stage.mab.anchor_3=1", "device.lens=none", "scene.size_m=3"});
    return rays(name).front();
  };
  // A volume around the head: every ray meets it.
  const double all = rays_of("radius", "1");
  for (const std::string map : {"radius", "lens"})
    EXPECT_NEAR(rays_of(map, "0.5"), 0.5 * all, 0.02 * all) << map;
}

TEST_F(Mab, LoadControlCastsFewerRays) {
  const std::vector<std::string> heavy = {"pipeline.rays=mab", "clock.cost_scale=40", "run.frames=40",
                                          "output.error=none"};
  for (const std::string control : {"mab_dynamic"}) {
    std::vector<std::string> settings = heavy;
    settings.push_back("pipeline.control=" + control);
    run(control, settings);
    const std::vector<double> cast = rays(control);
    ASSERT_GT(cast.size(), 5U);
    EXPECT_LT(cast.back(), 0.6 * cast.front()) << control;
    settings.push_back("output.images=none");
    run(control + "-counted", settings);
    EXPECT_NEAR(rays(control + "-counted").back(), cast.back(), 0.15 * cast.front()) << control;
  }
}

TEST_F(Mab, WrongLevelsAndStagesThatDoNotGoWithItAreRefusedByName) {
  const Outcome scales = try_run("a", {"pipeline.rays=mab", "stage.mab.scale_1=0.95"});
  EXPECT_EQ(scales.exit_code, 2);
  EXPECT_THAT(scales.err, HasSubstr("scale_1 = 0.95 is not below scale_0 = 0.9"));
  const Outcome anchors = try_run("b", {"pipeline.rays=mab", "stage.mab.anchor_2=0.2"});
  EXPECT_EQ(anchors.exit_code, 2);
  EXPECT_THAT(anchors.err, HasSubstr("anchor_2 = 0.2 is below anchor_1 = 0.3"));
  const Outcome layers = try_run(
      "c", {"pipeline.rays=mab", "pipeline.stereo=layers", "device.profile=valve-index", "device.lens=none"});
  EXPECT_EQ(layers.exit_code, 2);
  EXPECT_THAT(layers.err, HasSubstr("rays/mab"));
  EXPECT_THAT(layers.err, HasSubstr("canted"));
  EXPECT_THAT(place_.names(), ::testing::ElementsAre("s.toml"));
}

}  // namespace
}  // namespace brace
