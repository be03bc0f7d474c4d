#include "runtime/frame/counted_work.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace {
namespace {

JobOutcome cast_at(FrameWork& work, std::int64_t ns, double quality = 1.0) {
  return work.cast({.start = sim_time(ns), .quality = quality});
}

TEST(CountedWork, InterpolatesBetweenProbesAndHoldsTheEnds) {
  CountedWork work({{.time = sim_time(100), .cast = {.rays = 10, .samples = 1000}, .warp = {.texels = 1}},
                    {.time = sim_time(200), .cast = {.rays = 20, .samples = 3000}, .warp = {.texels = 101}},
                    {.time = sim_time(600), .cast = {.rays = 0, .samples = 3000}, .warp = {.texels = 101}}});
  EXPECT_EQ(cast_at(work, -5).work.samples, 1000U);
  EXPECT_EQ(cast_at(work, 100).work.samples, 1000U);
  EXPECT_EQ(cast_at(work, 125).work.samples, 1500U);
  EXPECT_EQ(work.warp({.start = sim_time(150)}).work.texels, 51U);
  EXPECT_EQ(cast_at(work, 200).work.rays, 20U);
  EXPECT_EQ(cast_at(work, 500).work.rays, 5U);
  EXPECT_EQ(cast_at(work, 10'000).work.rays, 0U);
  EXPECT_EQ(cast_at(work, 125).work.samples, 1500U) << "going back works, too";
  EXPECT_EQ(cast_at(work, 125).device_time, SimDuration(0));
}

TEST(CountedWork, RepeatsWithAPeriod) {
  CountedWork work(
      {{.time = sim_time(0), .cast = {.samples = 0}}, {.time = sim_time(1000), .cast = {.samples = 1000}}},
      SimDuration(1000));
  for (const std::int64_t turn : {0LL, 1LL, 7'800'000LL}) {
    EXPECT_EQ(cast_at(work, turn * 1000 + 250).work.samples, 250U);
    EXPECT_EQ(cast_at(work, turn * 1000 + 999).work.samples, 999U);
  }
}

TEST(CountedWork, InterpolatesBetweenQualitiesAndHoldsTheLowest) {
  CountedWork work({{.time = sim_time(0),
                     .cast = {.rays = 100, .samples = 1000},
                     .cast_below = {{.rays = 60, .samples = 400}, {.rays = 20, .samples = 200}}},
                    {.time = sim_time(100),
                     .cast = {.rays = 200, .samples = 2000},
                     .cast_below = {{.rays = 120, .samples = 800}, {.rays = 40, .samples = 400}}}},
                   SimDuration(0), {0.5, 0.25});
  EXPECT_EQ(cast_at(work, 0, 0.75).work, (WorkCounts{.rays = 80, .samples = 700}));
  EXPECT_EQ(cast_at(work, 0, 0.5).work, (WorkCounts{.rays = 60, .samples = 400}));
  EXPECT_EQ(cast_at(work, 50, 0.375).work, (WorkCounts{.rays = 60, .samples = 450}));
  EXPECT_EQ(cast_at(work, 0, 0.01).work, (WorkCounts{.rays = 20, .samples = 200}));
}

TEST(CountedWork, WithoutFurtherQualitiesNoneHasAnEffect) {
  CountedWork work({{.time = sim_time(0), .cast = {100, 1000, 60, 40, 30, 20}}});
  EXPECT_EQ(cast_at(work, 0, 0.25).work, (WorkCounts{100, 1000, 60, 40, 30, 20}));
}

TEST(CountedWork, RefusesTablesThatAreNone) {
  EXPECT_THROW(CountedWork({}), Error);
  EXPECT_THROW(CountedWork({{.time = sim_time(5)}, {.time = sim_time(5)}}), Error);
  EXPECT_THROW(CountedWork({{.time = sim_time(5)}}, SimDuration(-1)), Error);
  EXPECT_THROW(CountedWork({{.time = sim_time(5)}}, SimDuration(0), {0.5}), Error);
  EXPECT_THROW(CountedWork({{.time = sim_time(5), .cast_below = {{}}}}, SimDuration(0), {1.0}), Error);
}

}  // namespace
}  // namespace brace
