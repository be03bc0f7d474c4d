#include "runtime/mab/mab_plan.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace {
namespace {

MabSettings papers_levels() {
  MabSettings settings;
  settings.scale = {0.9, 0.7, 0.5, 0.3};
  settings.anchors = {4, {0, 0.3, 0.5, 0.7}, 0.05};
  return settings;
}

sim::DeviceProfile plain_headset() {
  sim::DeviceProfile profile;
  for (sim::EyeProfile& eye : profile.eyes) {
    eye.fov = {-1, 1, -1, 1};
    eye.lens = sim::identity_lens(eye.fov);
  }
  return profile;
}

MabPlan plan(const MabSettings& settings) {
  return MabPlan(settings, plain_headset(), {.eye_px = {108, 120}, .panel_px = {108, 120}});
}

TEST(MabPlan, FullQualityIsWhatTheSettingsSay) {
  const MabPlan papers = plan(papers_levels());
  EXPECT_EQ(papers.step_for(1.0), papers.steps());
  EXPECT_EQ(papers.rays(papers.steps()), papers.make_rays(sim::Eye::left, papers.steps()).live +
                                             papers.make_rays(sim::Eye::right, papers.steps()).live);
}

TEST(MabPlan, AQualityIsNeverExceededAndNearlyUsed) {
  const MabPlan papers = plan(papers_levels());
  const auto all = static_cast<double>(papers.rays(papers.steps()));
  for (double quality = 1.0; quality > papers.quality_min(); quality *= 0.97) {
    const double share = static_cast<double>(papers.rays(papers.step_for(quality))) / all;
    EXPECT_LE(share, quality);
    EXPECT_GT(share, quality - 0.06);
  }
  const int least = papers.step_for(1e-9);
  EXPECT_NEAR(static_cast<double>(papers.rays(least)) / all, papers.quality_min(), 1e-12);
  EXPECT_NEAR(papers.quality_min() * all, 2.0 * 32 * 36, 1.0) << "the coarsest level alone";
}

TEST(MabPlan, ALensThatAsksForEverythingHasTheRaysOfTheRadialMapAtEverySecondStep) {
  MabSettings settings = papers_levels();
  const MabPlan radius = plan(settings);
  settings.map = LevelMap::lens;
  const MabPlan lens = plan(settings);  // the panel asks for all
  ASSERT_EQ(lens.steps(), 2 * radius.steps());
  for (int step = 0; step <= radius.steps(); step += 5)
    EXPECT_EQ(lens.rays(step), radius.rays(step)) << step;
}

TEST(MabPlan, EveryStepsRaysFit) {
  for (const bool compact : {true, false}) {
    MabSettings settings = papers_levels();
    settings.compact = compact;
    const MabPlan papers = plan(settings);
    for (int step = 0; step <= papers.steps(); step += 8) {
      const MabRays rays = papers.make_rays(sim::Eye::right, step);
      EXPECT_LE(rays.texel_of_ray.size(), papers.capacity()) << step;
    }
  }
}

TEST(MabPlan, OneLevelAtScaleOneIsARayPerPixelAtEveryQuality) {
  MabSettings settings;
  settings.levels = 1;
  settings.scale = {1.0};
  settings.anchors.levels = 1;
  const MabPlan one = plan(settings);
  for (const double quality : {1.0, 0.5, 0.01})
    EXPECT_EQ(one.rays(one.step_for(quality)), 2U * 108 * 120);
  EXPECT_EQ(one.quality_min(), 1.0);
}

TEST(MabPlan, LevelsOfOnePixelWork) {
  MabSettings settings = papers_levels();
  settings.scale = {0.9, 0.01, 0.005, 0.001};
  const MabPlan tiny = plan(settings);
  EXPECT_EQ(tiny.atlas().levels.back().width, 1);
  EXPECT_EQ(tiny.rays(0), 2U);
}

TEST(MabPlan, AnAtlasBeyondWhatATexelsPlaceHoldsIsRefused) {
  const MabPlan::Sizes sizes{.eye_px = {20'000, 4}, .panel_px = {20'000, 4}};
  EXPECT_THROW(MabPlan(papers_levels(), plain_headset(), sizes), Error);
}

}  // namespace
}  // namespace brace
