#include "runtime/timeline/cost_source.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/timeline/costs_csv.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

template <typename Call>
std::string message_of(Call&& call, ExitCode expected = ExitCode::bad_input) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), expected) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}

constexpr WorkCounts some_work{
    .rays = 10, .samples = 1000, .skip_steps = 7, .shading_fetches = 50, .texels = 3, .bytes = 8};

CostModel some_model() {
  return {
      .name = "some",
      .summary = "",
      .base_ns = {.cast = 100, .warp = 20, .update = 3},
      .item_ns = {.ray = 2, .sample = 0.5, .skip_step = 0.25, .shading_fetch = 0.125, .texel = 4, .byte = 8}};
}

TEST(CostSource, MeasuredIsDeviceTimeTimesScaleAndNotDeterministic) {
  const auto cost = make_measured_cost(0.25);
  EXPECT_EQ(cost->cost({.work = some_work, .device_time = SimDuration(1'000'002)}), SimDuration(250'001));
  EXPECT_FALSE(cost->deterministic());
}

TEST(CostSource, ModelIsLinearInTheCountsPlusTheKindsBase) {
  const auto cost = make_model_cost(some_model(), 1.0, 1.0);
  const std::int64_t items_ns = 20 + 500 + 2 /* 1.75, with 6.25 below: 8 */ + 6 + 12 + 64;
  EXPECT_EQ(cost->cost({.kind = JobKind::cast, .work = some_work}).count(), 100 + items_ns);
  EXPECT_EQ(cost->cost({.kind = JobKind::warp, .work = some_work}).count(), 20 + items_ns);
  EXPECT_EQ(cost->cost({.kind = JobKind::update, .work = some_work}).count(), 3 + items_ns);
  EXPECT_EQ(cost->cost({.kind = JobKind::update}).count(), 3);
  EXPECT_TRUE(cost->deterministic());
}

TEST(CostSource, FullResolutionScalesPixelWorkAndNeitherBytesNorBase) {
  const double scale = 0.25;
  const WorkCounts full = scale_pixel_work(some_work, 1 / (scale * scale));
  EXPECT_EQ(full, (WorkCounts{.rays = 160,
                              .samples = 16'000,
                              .skip_steps = 112,
                              .shading_fetches = 800,
                              .texels = 48,
                              .bytes = 8}));
  const auto at_full = make_model_cost(some_model(), 16.0, 1.0);
  const auto as_rendered = make_model_cost(some_model(), 1.0, 1.0);
  EXPECT_EQ(at_full->cost({.work = some_work}), as_rendered->cost({.work = full}));
  EXPECT_EQ(at_full->cost({.kind = JobKind::warp}).count(), 20);
}

TEST(CostSource, ScaleMultipliesEveryDuration) {
  EXPECT_EQ(make_model_cost(some_model(), 1.0, 3.0)->cost({.kind = JobKind::warp}).count(), 60);
  EXPECT_EQ(make_scripted_cost({{0, 1, 2, 0}}, 3.0)->cost({}).count(), 3'000'000);
  EXPECT_EQ(make_recorded_cost(std::vector<JobRecord>{{.cost_ns = 7}}, "r", 3.0)->cost({}).count(), 21);
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(message_of([&] { make_measured_cost(bad); }), HasSubstr("above 0"));
  }
}

TEST(CostSource, CostsBeyondTheClockAreAnErrorNotAnOverflow) {
  CostModel model = some_model();
  model.item_ns.sample = 1e12;
  const WorkCounts work{.samples = 1'000'000'000'000};
  EXPECT_THAT(message_of([&] { make_model_cost(model, 1.0, 1.0)->cost({.work = work}); }), HasSubstr("2^63"));
}

std::vector<JobRecord> recording() {
  return {{.job = 0, .kind = JobKind::cast, .index = 0, .cost_ns = 11},
          {.job = 1, .kind = JobKind::warp, .index = 5, .cost_ns = 21},
          {.job = 2, .kind = JobKind::warp, .index = 4, .cost_ns = 22},  // out of order on purpose
          {.job = 3, .kind = JobKind::cast, .index = 1, .end_ns = -1, .cost_ns = 12}};
}

TEST(CostSource, RecordedGivesEachKindItsCostsInTheOrderOfFrameOrVsync) {
  const auto cost = make_recorded_cost(recording(), "run", 1.0);
  EXPECT_EQ(cost->cost({.kind = JobKind::cast}).count(), 11);
  EXPECT_EQ(cost->cost({.kind = JobKind::warp}).count(), 22);
  EXPECT_EQ(cost->cost({.kind = JobKind::cast}).count(), 12) << "an unfinished job is part of the recording";
  EXPECT_EQ(cost->cost({.kind = JobKind::warp}).count(), 21);
  EXPECT_TRUE(cost->deterministic());
}

TEST(CostSource, RecordedSaysWhatIsMissingAtItsEnd) {
  const auto cost = make_recorded_cost(recording(), "runs/a/costs.csv", 1.0);
  cost->cost({.kind = JobKind::cast});
  cost->cost({.kind = JobKind::cast});
  const std::string message =
      message_of([&] { cost->cost({.kind = JobKind::cast, .elapsed = SimDuration(2'500'000'000)}); });
  EXPECT_THAT(message, HasSubstr("runs/a/costs.csv"));
  EXPECT_THAT(message, HasSubstr("2 cast jobs"));
  EXPECT_THAT(message, HasSubstr("2.500 s"));
  EXPECT_THAT(message, HasSubstr("--frames"));
}

TEST(CostSource, RecordedReadsARunDirectoryOrItsFile) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "recorded_run";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "costs.csv") << to_costs_csv(recording());
  for (const auto& path : {folder, folder / "costs.csv"}) {
    EXPECT_EQ(make_recorded_cost(path, 1.0)->cost({.kind = JobKind::warp}).count(), 22);
  }
  EXPECT_THAT(message_of([&] { make_recorded_cost(folder / "none", 1.0); }), HasSubstr("none"));
  std::filesystem::remove_all(folder);
}

TEST(CostSource, ScriptedHoldsASegmentUntilTheNext) {
  const auto cost = make_scripted_cost({{0, 5, 1, 0.5}, {1.5, 50, 2, 0}}, 1.0);
  const auto at = [&](std::int64_t elapsed_ns, JobKind kind) {
    return cost->cost({.kind = kind, .elapsed = SimDuration(elapsed_ns)}).count();
  };
  EXPECT_EQ(at(0, JobKind::cast), 5'000'000);
  EXPECT_EQ(at(0, JobKind::update), 500'000);
  EXPECT_EQ(at(1'499'999'999, JobKind::warp), 1'000'000);
  EXPECT_EQ(at(1'500'000'000, JobKind::cast), 50'000'000);
  EXPECT_EQ(at(9'000'000'000'000, JobKind::warp), 2'000'000);
}

TEST(CostSource, ScriptedRefusesSegmentsThatDoNotMakeATimeline) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message_of([] { make_scripted_cost({}, 1.0); }), HasSubstr("from_s = 0"));
  EXPECT_THAT(message_of([] { make_scripted_cost({{1, 1, 1, 0}}, 1.0); }), HasSubstr("from_s = 0"));
  EXPECT_THAT(message_of([] {
                make_scripted_cost({{0, 1, 1, 0}, {0, 2, 2, 0}}, 1.0);
              }),
              HasSubstr("does not come after"));
  EXPECT_THAT(message_of([] { make_scripted_cost({{0, -1, 1, 0}}, 1.0); }), HasSubstr("cast_ms"));
  EXPECT_THAT(message_of([&] { make_scripted_cost({{0, 1, nan, 0}}, 1.0); }), HasSubstr("warp_ms"));
  EXPECT_THAT(message_of([&] {
                make_scripted_cost({{0, 1, 1, 0}, {nan, 1, 1, 0}}, 1.0);
              }),
              HasSubstr("from_s"));
}

brace_result plugin_cost(void* self, const char* job, const brace_work_counts* work,
                         std::int64_t* duration_ns) {
  if (std::strcmp(job, "update") == 0) return BRACE_ERROR;
  *duration_ns = std::strcmp(job, "warp") == 0
                     ? -5
                     : static_cast<std::int64_t>(work->samples + work->bytes + *static_cast<unsigned*>(self));
  return BRACE_OK;
}

TEST(CostSource, PluginsFitBehindTheSameInterface) {
  const brace_cost_functions functions{sizeof(brace_cost_functions), plugin_cost};
  unsigned offset = 4;
  const auto cost = make_plugin_cost(functions, &offset, "cost/mine", 2.0, 10.0);
  EXPECT_EQ(cost->cost({.work = some_work}).count(), (2000 + 8 + 4) * 10);
  EXPECT_THAT(message_of([&] { cost->cost({.kind = JobKind::update}); }, ExitCode::device_or_plugin_failed),
              HasSubstr("cost/mine"));
  EXPECT_THAT(message_of([&] { cost->cost({.kind = JobKind::warp}); }, ExitCode::device_or_plugin_failed),
              HasSubstr("-5 ns"));
}

}  // namespace
}  // namespace brace
